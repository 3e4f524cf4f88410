//! Load, angle of attack and the acceleration along the flight path.

use libm::{asin, cos, sin, sqrt};

use super::attitude::Orientation;
use super::path::Path;
use super::sample_tracker::is_current;
use fcc_core::blocks::{LowPass, limit, limit_abs};
use fcc_core::flight::{Measurements, SpecificForce};
use fcc_core::framework::Time;
use fcc_core::units::GRAVITY_MPS2;

/// What the accelerometers say of the air's force.
///
/// ```
/// use fcc_navigation::Lift;
///
/// assert_eq!(Lift::default().load_factor, 1.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lift {
    /// Load factor, g, along the body's z axis, upwards.
    pub load_factor: f64,
    /// Standard deviation of the load that gusts cause, g.
    pub gust_load: f64,
    /// Angle of attack, rad.
    pub angle_of_attack_rad: f64,
    /// Acceleration along the flight path without that of the air, m/s².
    pub acceleration_mps2: f64,
}

impl Default for Lift {
    fn default() -> Self {
        Self {
            load_factor: 1.0,
            gust_load: 0.0,
            angle_of_attack_rad: 0.0,
            acceleration_mps2: 0.0,
        }
    }
}

/// Load, angle of attack and the acceleration along the flight path, from the
/// accelerometers.
///
/// The angle of attack follows from the lift: α = α₀ + a·n/V² below the stall
/// (lift n·W = ½ρV²·S·c(α); Stevens, Lewis and Johnson 2016, section 2.3). Where it is
/// measured too, it is the middle one of that, the measured one, and pitch less path: a
/// vane that jams, a vertical wind, and a stall, beyond which the lift no longer follows,
/// falsify one of the three. The line leads from the angle
/// without lift to the stalling angle at the stalling speed; it is moved in
/// flight, slowly and within 3°, to pitch less path angle
/// where the flight is not accelerated. A vertical wind falsifies the latter,
/// but not the lift.
#[derive(Clone, Debug)]
pub struct LiftChannel {
    stall_airspeed_mps: f64,
    load: LowPass,
    slow_load: LowPass,
    gust_square: LowPass,
    /// What was learned of the angle without lift, rad.
    learned_rad: f64,
}

/// The angle of attack without lift, and that of the stall, of an unswept wing
/// without flaps: those of JSBSim's Cessna 172 (lift table of c172p.xml), close
/// to the NACA 2412 section (Abbott and von Doenhoff 1959, appendix IV).
const ZERO_LIFT_RAD: f64 = -0.047;
/// See above.
pub(crate) const STALL_RAD: f64 = 0.28;

/// Learned in this time, s: longer than a gust or a thermal.
const LEARNING_S: f64 = 30.0;
/// At most this much is learned, rad (3°): an error of rigging, loading or the
/// attitude's zero.
const MOST_LEARNED_RAD: f64 = 0.052;
/// A larger difference is a vertical wind, rad (5°: 3 m/s at 65 kt).
const WIND_RAD: f64 = 0.087;
/// Learned below this bank, rad (15°), and load off 1, g.
const LEARNING_BANK_RAD: f64 = 0.26;
const LEARNING_LOAD: f64 = 0.15;

/// The load is filtered as long as the lift takes to follow the angle of
/// attack, s.
const LOAD_TAU_S: f64 = 0.1;
/// Loads that last longer are not gusts but the flight path's, s.
const PATH_TAU_S: f64 = 2.0;
/// The gusts of so long a time count, s.
const GUST_TAU_S: f64 = 10.0;

impl LiftChannel {
    /// A channel for an aircraft with this stalling speed, clean and without
    /// power, m/s.
    pub const fn new(stall_airspeed_mps: f64) -> Self {
        Self {
            stall_airspeed_mps,
            load: LowPass::new(LOAD_TAU_S),
            slow_load: LowPass::new(PATH_TAU_S),
            gust_square: LowPass::new(GUST_TAU_S),
            learned_rad: 0.0,
        }
    }

    /// The same channel in its initial state.
    pub(super) const fn renewed(&self) -> Self {
        Self::new(self.stall_airspeed_mps)
    }

    /// One step.
    pub(super) fn step(
        &mut self,
        now: Time,
        measurements: &Measurements,
        path: &Path<'_>,
        airspeed_mps: f64,
        dt_s: f64,
    ) -> Lift {
        let force = measurements.specific_force;
        if !is_current(&force, now) {
            return Lift::default();
        }
        let load_factor = self.load.step(-force.value.z_mps2 / GRAVITY_MPS2, dt_s);
        let gust = load_factor - self.slow_load.step(load_factor, dt_s);
        let gust_load = sqrt(self.gust_square.step(gust * gust, dt_s).max(0.0));
        let true_mps = airspeed_mps / path.sqrt_density;
        let sin_path = path.vertical.climb_rate_mps / true_mps.max(1.0);
        let by_lift_rad =
            self.angle_of_attack(load_factor, path.orientation, sin_path, airspeed_mps, dt_s);
        let measured = measurements.angle_of_attack_rad;
        let angle_of_attack_rad = if is_current(&measured, now) {
            let by_path_rad = path.upward.angle_of_attack_rad(sin_path);
            let (low, high) = (by_lift_rad.min(by_path_rad), by_lift_rad.max(by_path_rad));
            limit(measured.value, low, high)
        } else {
            by_lift_rad
        };
        Lift {
            load_factor,
            gust_load,
            angle_of_attack_rad,
            acceleration_mps2: acceleration(&force.value, angle_of_attack_rad, path.orientation),
        }
    }

    fn angle_of_attack(
        &mut self,
        load_factor: f64,
        orientation: &Orientation,
        sin_path: f64,
        airspeed_mps: f64,
        dt_s: f64,
    ) -> f64 {
        // The lift coefficient over its largest.
        let ratio = self.stall_airspeed_mps / airspeed_mps.max(0.5 * self.stall_airspeed_mps);
        let lift = load_factor * ratio * ratio;
        let by_lift = ZERO_LIFT_RAD + (STALL_RAD - ZERO_LIFT_RAD) * lift;
        let steady = orientation.roll_rad.abs() < LEARNING_BANK_RAD
            && (load_factor - 1.0).abs() < LEARNING_LOAD
            && lift < 0.7;
        if steady && airspeed_mps > self.stall_airspeed_mps {
            let by_path = orientation.pitch_rad - asin(limit_abs(sin_path, 0.5));
            let off = by_path - by_lift - self.learned_rad;
            if off.abs() < WIND_RAD {
                let learned_rad = self.learned_rad + off * (dt_s / LEARNING_S).min(1.0);
                self.learned_rad = limit_abs(learned_rad, MOST_LEARNED_RAD);
            }
        }
        limit(by_lift + self.learned_rad, -STALL_RAD, 2.0 * STALL_RAD)
    }
}

/// The acceleration along the flight path: the specific force along it less
/// gravity. An error of the angle of attack turns both by the same angle, and
/// cancels at the load of steady flight.
fn acceleration(force: &SpecificForce, alpha: f64, orientation: &Orientation) -> f64 {
    let (sine, cosine) = (sin(alpha), cos(alpha));
    let path_sine = sin(orientation.pitch_rad) * cosine
        - cos(orientation.pitch_rad) * cos(orientation.roll_rad) * sine;
    force.x_mps2 * cosine + force.z_mps2 * sine - GRAVITY_MPS2 * path_sine
}

#[cfg(test)]
mod tests {
    use super::super::upward::Upward;
    use super::super::vertical::VerticalState;
    use super::*;
    use fcc_core::framework::Reading;

    /// The channel after `seconds` of steady flight.
    fn flown(
        channel: &mut LiftChannel,
        force: SpecificForce,
        path: &Path<'_>,
        airspeed_mps: f64,
        seconds: f64,
    ) -> Lift {
        let mut lift = Lift::default();
        for tick in 1..=(seconds * 40.0) as i64 {
            let now = Time::from_nanos(tick * 25_000_000);
            let measured = Measurements {
                specific_force: Reading::new(force, now),
                ..Measurements::default()
            };
            lift = channel.step(now, &measured, path, airspeed_mps, 0.025);
        }
        lift
    }

    /// At √2 times the stalling speed the wing has half of its largest lift
    /// coefficient: JSBSim's c172p has 0.73 of 1.47 at 0.09 rad.
    #[test]
    fn the_angle_of_attack_follows_from_the_lift() {
        let orientation = Orientation::default();
        let stall_mps = 24.2;
        let airspeed_mps = stall_mps * core::f64::consts::SQRT_2;
        let path = Path {
            orientation: &orientation,
            upward: Upward::LEVEL,
            vertical: VerticalState::default(),
            sqrt_density: 1.0,
        };
        let level = SpecificForce {
            z_mps2: -GRAVITY_MPS2,
            ..SpecificForce::default()
        };
        let lift = flown(
            &mut LiftChannel::new(stall_mps),
            level,
            &path,
            airspeed_mps,
            0.1,
        );
        assert!((lift.load_factor - 1.0).abs() < 1e-9);
        assert!((lift.angle_of_attack_rad - 0.09).abs() < 0.03);
    }

    /// A rod-like aircraft that falls with 30° of pitch down and no force along
    /// its path gains speed by g sin 30°.
    #[test]
    fn a_dive_without_drag_accelerates_by_gravity() {
        let orientation = Orientation {
            pitch_rad: -30.0_f64.to_radians(),
            ..Orientation::default()
        };
        let force = SpecificForce {
            z_mps2: -GRAVITY_MPS2 * orientation.pitch_rad.cos(),
            ..SpecificForce::default()
        };
        let exact = 0.5 * GRAVITY_MPS2;
        // Whatever the angle of attack is believed to be, within 10°.
        for alpha in [-0.05_f64, 0.0, 0.17] {
            let found = acceleration(&force, alpha, &orientation);
            assert!((found - exact).abs() < 0.1, "{found} at {alpha}");
        }
    }
}
