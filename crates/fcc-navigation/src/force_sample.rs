//! The forces on the aircraft and its motion, as models of its airspeed use them.

use libm::{cos, sin};

use super::upward::Upward;
use fcc_core::blocks::limit_abs;
use fcc_core::units::GRAVITY_MPS2;

/// Beyond these the models of the forces do not hold: bank and pitch in rad
/// (60°, 45°), load in g.
const STEEP_BANK_RAD: f64 = 1.05;
const STEEP_PITCH_RAD: f64 = 0.79;
const LOADS: core::ops::RangeInclusive<f64> = 0.3..=2.5;

/// Slower nothing flies, m/s.
pub(super) const LEAST_AIRSPEED_MPS: f64 = 15.0;
/// The airspeed of a path is at least this, m/s.
pub(super) const MIN_AIRSPEED_MPS: f64 = 5.0;

/// What the filter's models need, averaged over the time between two
/// corrections.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceSample {
    /// Specific force forward and up along the body axes, in g.
    pub(super) forward: f64,
    pub(super) up: f64,
    pub(super) pitch_rad: f64,
    pub(super) roll_rad: f64,
    /// By roll and pitch.
    pub(super) upward: Upward,
    pub(super) climb_rate_mps: f64,
    /// The climb rate comes from lift itself: the altimeter is doubted.
    pub(super) climbs_by_lift: bool,
    /// √(density over its value at sea level).
    pub(super) sqrt_density: f64,
    /// Thrust over that at full throttle and V₀, and what of its change over seconds is not
    /// known, one standard deviation; none if the throttle is not known.
    pub(super) thrust: Option<(f64, f64)>,
    /// Standard deviation of vertical gusts, m/s.
    pub(super) gusts_mps: f64,
}

impl ForceSample {
    /// Nothing measured.
    pub(super) const NONE: Self = Self {
        forward: 0.0,
        up: 0.0,
        pitch_rad: 0.0,
        roll_rad: 0.0,
        upward: Upward::LEVEL,
        climb_rate_mps: 0.0,
        climbs_by_lift: false,
        sqrt_density: 0.0,
        thrust: None,
        gusts_mps: 0.0,
    };

    /// Whether the models of the forces hold.
    pub(super) fn models_hold(&self) -> bool {
        self.roll_rad.abs() < STEEP_BANK_RAD
            && self.pitch_rad.abs() < STEEP_PITCH_RAD
            && LOADS.contains(&self.up)
    }
}

/// Specific force in m/s² to weights, forward and up.
pub(super) fn in_g(x_mps2: f64, z_mps2: f64) -> (f64, f64) {
    (x_mps2 / GRAVITY_MPS2, -z_mps2 / GRAVITY_MPS2)
}

/// Acceleration of the indicated airspeed along the path, m/s², from the forces
/// in g; without vertical wind, whose effect is of second order.
pub(super) fn acceleration_mps2(sample: &ForceSample, airspeed_mps: f64) -> f64 {
    let sin_path = sin_path(sample, airspeed_mps);
    let alpha = limit_abs(sample.upward.angle_of_attack_rad(sin_path), 0.3);
    let along = sample.forward * cos(alpha) - sample.up * sin(alpha) - sin_path;
    GRAVITY_MPS2 * along * sample.sqrt_density
}

fn sin_path(sample: &ForceSample, airspeed_mps: f64) -> f64 {
    let true_mps = airspeed_mps.max(MIN_AIRSPEED_MPS) / sample.sqrt_density;
    limit_abs(sample.climb_rate_mps / true_mps, 1.0)
}
