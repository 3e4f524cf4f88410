//! The airframe: where the rotors are, and what they do to the body.

use core::f64::consts::{PI, TAU};
use core::fmt;

use fcc_core::flight::MOST_ROTORS;
use fcc_core::units::GRAVITY_MPS2;
use libm::{cos, sin, sqrt};
use nalgebra::{SMatrix, Vector3, Vector4};

/// From the shares of thrust of the rotors to specific thrust, m/s², and angular accelerations
/// about x, y, z, rad/s².
pub(crate) type Effectiveness = SMatrix<f64, 4, MOST_ROTORS>;

/// A rotor.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rotor {
    /// From the centre of gravity, body axes, m.
    pub place_m: Vector3<f64>,
    /// The direction of its thrust, of unit length, body axes.
    pub axis: Vector3<f64>,
    /// 1 clockwise seen from where its thrust points to, -1 the other way.
    pub spin: f64,
}

/// A multicopter of up to [`MOST_ROTORS`] equal rotors.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Airframe {
    /// Its rotors; none where there is none.
    pub rotors: [Option<Rotor>; MOST_ROTORS],
    /// Mass, kg.
    pub mass_kg: f64,
    /// About the body axes, kg m².
    pub inertia_kgm2: Vector3<f64>,
    /// Thrust of one rotor at full speed, N.
    pub rotor_thrust_n: f64,
    /// Torque over thrust of a rotor, m.
    pub torque_ratio_m: f64,
    /// Time constant of a motor's speed, s.
    pub motor_lag_s: f64,
    /// Thrust over speed: 0 linear, 1 by the square.
    pub thrust_curve: f64,
}

/// Why a multicopter cannot be flown as configured.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Refusal {
    /// Control acts too late.
    TooSlow {
        /// The delay of control, s.
        delay_s: f64,
        /// The longest that can be flown, s.
        longest_s: f64,
    },
    /// The rotors cannot turn the body about an axis without another one.
    NotControllable,
    /// The share of full thrust that hovering takes.
    Hover(f64),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooSlow { delay_s, longest_s } => write!(
                f,
                "motors, sensors and the loop's period delay control by {:.0} ms, and at most \
                 {:.0} ms can be flown: use a higher rate, a lower latency or faster motors",
                delay_s * 1e3,
                longest_s * 1e3
            ),
            Self::NotControllable => f.write_str(
                "the rotors do not control thrust, roll, pitch and yaw independently: check their \
                 places and spins",
            ),
            Self::Hover(share) => write!(
                f,
                "hovering takes {:.0} % of the thrust, and 10 to 70 % can be flown: check mass \
                 and thrust",
                100.0 * share
            ),
        }
    }
}

impl core::error::Error for Refusal {}

impl Default for Airframe {
    /// A quadrotor of 1.4 kg with arms of 0.23 m and propellers of 10 inches.
    fn default() -> Self {
        Self {
            rotors: [None; MOST_ROTORS],
            mass_kg: 1.4,
            inertia_kgm2: Vector3::new(0.019, 0.019, 0.0252),
            rotor_thrust_n: 11.8,
            torque_ratio_m: 0.016,
            motor_lag_s: 0.03,
            thrust_curve: 1.0,
        }
        .with_ring(4, 0.233)
    }
}

impl Airframe {
    /// The same with `count` rotors on a circle of `arm_m`, upwards, the first half of an angle
    /// between two to the right of the nose, the next ones clockwise; they spin alternately,
    /// the first one counter-clockwise.
    #[must_use]
    pub fn with_ring(self, count: usize, arm_m: f64) -> Self {
        let mut spin = 1.0;
        let mut angle_rad = -PI / count.max(1) as f64;
        let rotors = core::array::from_fn(|index| {
            spin = -spin;
            angle_rad += TAU / count.max(1) as f64;
            (index < count).then_some(Rotor {
                place_m: Vector3::new(arm_m * cos(angle_rad), arm_m * sin(angle_rad), 0.0),
                axis: -Vector3::z(),
                spin,
            })
        });
        Self { rotors, ..self }
    }

    /// What full thrust of each rotor does: F d and r × F d + spin c F d, over mass and
    /// inertia. A rotor that turns clockwise drives the body counter-clockwise.
    pub(crate) fn effectiveness(&self) -> Effectiveness {
        let mut columns = Effectiveness::zeros();
        for (mut column, rotor) in columns.column_iter_mut().zip(&self.rotors) {
            let Some(rotor) = rotor else { continue };
            let force = rotor.axis * self.rotor_thrust_n;
            let torque = rotor.place_m.cross(&force) + force * (rotor.spin * self.torque_ratio_m);
            let turn = torque.component_div(&self.inertia_kgm2);
            column.copy_from(&Vector4::new(
                -force.z / self.mass_kg,
                turn.x,
                turn.y,
                turn.z,
            ));
        }
        columns
    }

    /// The lag of a motor that is led: of one slower than 30 ms a third is left, since a lead by
    /// more amplifies the noise of turn rates as much.
    pub(crate) fn led_lag_s(&self) -> f64 {
        self.motor_lag_s.min((self.motor_lag_s / 3.0).max(0.03))
    }

    /// The share of full thrust that hovering takes by mass and thrust.
    pub fn hover_share(&self) -> f64 {
        GRAVITY_MPS2 / self.effectiveness().row(0).sum()
    }

    /// The speed of a motor, 0..=1, that gives a share of its thrust, 0..=1.
    pub fn speed_of(&self, share: f64) -> f64 {
        let (square, linear) = (self.thrust_curve, 1.0 - self.thrust_curve);
        if square < 1e-6 {
            return share.clamp(0.0, 1.0);
        }
        let root = sqrt(linear * linear + 4.0 * square * share.max(0.0));
        ((root - linear) / (2.0 * square)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F450 of JSBSim: 0.407 of the speed gives 1/3.7 of the thrust.
    #[test]
    fn a_mixed_curve_is_inverted() {
        let airframe = Airframe {
            thrust_curve: 0.566,
            ..Airframe::default()
        };
        assert!((airframe.speed_of(1.0 / 3.7) - 0.407).abs() < 1e-3);
        assert!((airframe.speed_of(1.0) - 1.0).abs() < 1e-12);
    }

    /// By hand: more thrust of the right rotors rolls left, of the front ones raises the nose,
    /// of those that turn counter-clockwise yaws right.
    #[test]
    fn signs_are_those_of_the_body_axes() {
        let effect = Airframe::default().effectiveness();
        let signs = |row: usize| {
            let row = effect.row(row);
            [0, 1, 2, 3].map(|rotor| row[rotor].signum())
        };
        // Front right, rear right, rear left, front left.
        assert_eq!(signs(1), [-1.0, -1.0, 1.0, 1.0]);
        assert_eq!(signs(2), [1.0, -1.0, -1.0, 1.0]);
        assert_eq!(signs(3), [1.0, -1.0, 1.0, -1.0]);
    }
}
