//! From a path to the thrust that follows it.

use fcc_core::units::GRAVITY_MPS2;
use libm::{hypot, sqrt};
use nalgebra::Vector3;

use crate::estimator::State;
use crate::gains::Gains;

/// The collective is at least this share of full thrust: below, the rotors do not control.
const LEAST_SHARE: f64 = 0.12;
/// And at most this one: the rest is for roll and pitch.
const MOST_SHARE: f64 = 0.9;
/// Of full thrust, this share is kept for sideways if it is wanted.
const SIDEWAYS_SHARE: f64 = 0.3;
/// Of the integral: the drag in a storm, m/s².
const MOST_INTEGRAL_MPS2: f64 = 6.0;

/// Where to be, and how to move.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Reference {
    /// North, east, down, m.
    pub position_m: Vector3<f64>,
    /// m/s.
    pub velocity_mps: Vector3<f64>,
    /// m/s².
    pub acceleration_mps2: Vector3<f64>,
    /// Of the nose, rad.
    pub heading_rad: f64,
    /// rad/s.
    pub heading_rate_radps: f64,
    /// Whether it descends to the ground: then the vertical velocity is held, and not the
    /// height.
    pub descends: bool,
}

/// Position, proportional; velocity, with an integral; and the reference's own motion.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PositionLoop {
    gains: Gains,
    integral_mps2: Vector3<f64>,
}

impl PositionLoop {
    /// With these gains.
    pub fn new(gains: Gains) -> Self {
        Self {
            gains,
            integral_mps2: Vector3::zeros(),
        }
    }

    /// Forgets what it has learned of the wind.
    pub fn reset(&mut self) {
        self.integral_mps2 = Vector3::zeros();
    }

    /// The hover thrust became another one: the thrust stays the same.
    pub fn rescale(&mut self, before_over_after: f64) {
        // Down is positive: up + g is what thrust is in proportion to.
        let up = GRAVITY_MPS2 - self.integral_mps2.z;
        self.integral_mps2.z = GRAVITY_MPS2 - up * before_over_after;
    }

    /// The specific thrust that follows a reference, north-east-down, m/s², within a tilt,
    /// given as its tangent, and a share of full thrust that hovering takes. Height comes before
    /// place.
    pub fn step(
        &mut self,
        state: &State,
        reference: &Reference,
        tan_tilt: f64,
        hover: f64,
        dt_s: f64,
    ) -> Vector3<f64> {
        let gains = &self.gains;
        let mut off_m = reference.position_m - state.position_m;
        if reference.descends {
            off_m.z = 0.0;
        }
        let error =
            reference.velocity_mps + off_m.component_mul(&gains.position) - state.velocity_mps;
        let wanted =
            reference.acceleration_mps2 + error.component_mul(&gains.velocity) + self.integral_mps2
                - state.drag_mps2;
        let thrust = limited(&wanted, tan_tilt, hover);
        let possible = thrust + Vector3::new(0.0, 0.0, GRAVITY_MPS2);
        let error = error - (wanted - possible).component_div(&gains.velocity);
        let integral = self.integral_mps2 + error.component_mul(&gains.velocity_integral) * dt_s;
        self.integral_mps2 =
            integral.map(|axis| axis.clamp(-MOST_INTEGRAL_MPS2, MOST_INTEGRAL_MPS2));
        thrust
    }
}

/// The specific thrust of an acceleration, within what is possible.
fn limited(wanted_mps2: &Vector3<f64>, tan_tilt: f64, hover: f64) -> Vector3<f64> {
    let per_share = GRAVITY_MPS2 / hover;
    let most = MOST_SHARE * per_share;
    let level = hypot(wanted_mps2.x, wanted_mps2.y);
    let kept = level.min(SIDEWAYS_SHARE * per_share);
    let highest = sqrt(most * most - kept * kept);
    let up = (GRAVITY_MPS2 - wanted_mps2.z).clamp(LEAST_SHARE * per_share, highest);
    let sideways = (tan_tilt * up).min(sqrt(most * most - up * up));
    let scale = (sideways / level.max(1e-9)).min(1.0);
    Vector3::new(wanted_mps2.x * scale, wanted_mps2.y * scale, -up)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::Airframe;

    fn position_loop() -> PositionLoop {
        PositionLoop::new(Gains::of(&Airframe::default(), 0.002_5, 0.01).unwrap())
    }

    /// Full thrust is 1/0.3 g, of which 0.9 are used: 29.4 m/s². A climb that takes all of it
    /// leaves 0.3 of full thrust to go sideways, 9.8 m/s².
    #[test]
    fn height_comes_before_place() {
        let thrust = limited(&Vector3::new(50.0, 0.0, -30.0), 1.0, 0.3);
        assert!(
            (thrust.norm() - 29.42).abs() < 0.01 && (thrust.x - 9.81).abs() < 0.01,
            "{thrust}"
        );
        let thrust = limited(&Vector3::new(0.0, -50.0, 0.0), 1.0, 0.3);
        assert!(
            (thrust.y + GRAVITY_MPS2).abs() < 1e-9,
            "45° of tilt: {thrust}"
        );
        let thrust = limited(&Vector3::new(0.0, 0.0, 50.0), 1.0, 0.3);
        assert!(
            (thrust.z + 0.12 * GRAVITY_MPS2 / 0.3).abs() < 1e-9,
            "{thrust}"
        );
    }

    /// What cannot be given does not wind up: after 10 s out of reach it brakes within a tick
    /// of being there.
    #[test]
    fn saturation_does_not_wind_up() {
        let mut position = position_loop();
        let far = Reference {
            position_m: Vector3::new(100.0, 0.0, 0.0),
            ..Reference::default()
        };
        for _ in 0..4_000 {
            position.step(&State::default(), &far, 1.0, 0.4, 0.0025);
        }
        let there = State {
            position_m: far.position_m,
            velocity_mps: Vector3::new(3.0, 0.0, 0.0),
            ..State::default()
        };
        let thrust = position.step(&there, &far, 1.0, 0.4, 0.0025);
        assert!(thrust.x < 0.0, "{thrust}");
    }

    #[test]
    fn another_hover_thrust_leaves_the_thrust_as_it_is() {
        let mut position = position_loop();
        let state = State::default();
        let reference = Reference::default();
        let before = position.step(&state, &reference, 1.0, 0.4, 0.0) * 0.4;
        position.rescale(0.4 / 0.45);
        let after = position.step(&state, &reference, 1.0, 0.45, 0.0) * 0.45;
        assert!((before - after).norm() < 1e-9, "{before} {after}");
    }
}
