//! Bank by the rudder, and climb by the throttle: while ailerons or elevator do not move the
//! aircraft.
//!
//! An aircraft with dihedral rolls towards where its rudder yaws it, and one that is trimmed
//! climbs by what its thrust exceeds its drag, at the airspeed that it is trimmed for. Its
//! phugoid is damped by the thrust against changes of the airspeed. (Tucker 1999, Touchdown,
//! Monographs in Aerospace History 16: two aircraft landed by their engines alone.)

use libm::sin;

use super::{AirspeedConfig, Schedule};
use crate::blocks::{LowPass, limit, limit_abs};
use crate::flight::navigation::Estimate;
use crate::units::GRAVITY_MPS2;

/// Rudder for a bank error, for its integral, against the roll rate and against a yaw rate in
/// excess of the turn's; per rad, rad·s and rad/s, at the reference airspeed.
const RUDDER_PER_BANK: f64 = 1.0;
const RUDDER_PER_BANK_S: f64 = 0.1;
const RUDDER_PER_ROLL_RATE: f64 = 0.5;
const RUDDER_PER_YAW_RATE: f64 = 0.3;

/// The bank is held by the rudder.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BankByRudder {
    integral: f64,
}

impl BankByRudder {
    /// The rudder for a bank (rad), from the rudder's trim.
    pub(crate) fn step(
        &mut self,
        bank_rad: f64,
        trim: f64,
        estimate: &Estimate,
        schedule: Schedule,
        dt_s: f64,
    ) -> f64 {
        let error_rad = bank_rad - estimate.roll_rad;
        self.integral = limit_abs(self.integral + RUDDER_PER_BANK_S * error_rad * dt_s, 1.0);
        let turn_radps =
            GRAVITY_MPS2 / estimate.true_airspeed_mps.max(1.0) * sin(estimate.roll_rad);
        let rates = estimate.body_rates;
        let rudder = RUDDER_PER_BANK * error_rad
            - RUDDER_PER_ROLL_RATE * rates.roll_radps
            - RUDDER_PER_YAW_RATE * (rates.yaw_radps - turn_radps);
        limit_abs(trim + self.integral + schedule.rate * rudder, 1.0)
    }
}

/// The climb rate that is commanded for an altitude error, 1/s, and at most, m/s.
const CLIMB_PER_ALTITUDE: f64 = 0.05;
const MOST_CLIMB_MPS: f64 = 3.0;
/// Acceleration for a change of the airspeed against its mean of so many seconds, 1/s.
const DAMPING_PER_S: f64 = 0.27;
const MEAN_S: f64 = 20.0;
/// The integral of the climb rate's error, 1/s, and its limit as a throttle.
const INTEGRAL_PER_S: f64 = 0.07;
const MOST_INTEGRAL: f64 = 0.6;

/// The altitude is held by the throttle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClimbByThrottle {
    airspeed: LowPass,
    integral: f64,
}

impl Default for ClimbByThrottle {
    fn default() -> Self {
        Self {
            airspeed: LowPass::new(MEAN_S),
            integral: 0.0,
        }
    }
}

impl ClimbByThrottle {
    /// The throttle, 0..=1, towards an altitude (m), from that of level flight, and the climb
    /// rate that is wanted, m/s.
    pub(crate) fn step(
        &mut self,
        altitude_m: f64,
        level: f64,
        estimate: &Estimate,
        config: &AirspeedConfig,
        dt_s: f64,
    ) -> (f64, f64) {
        let wanted_mps = limit_abs(
            CLIMB_PER_ALTITUDE * (altitude_m - estimate.altitude_m),
            MOST_CLIMB_MPS,
        );
        // A climb takes V̇ = g sin γ.
        let per_climb_per_s = GRAVITY_MPS2 / estimate.true_airspeed_mps.max(1.0);
        let mean_mps = self.airspeed.step(estimate.airspeed_mps, dt_s);
        let missed_mps = wanted_mps - estimate.climb_rate_mps;
        let increment =
            config.throttle_per_mps2 * per_climb_per_s * INTEGRAL_PER_S * missed_mps * dt_s;
        self.integral = limit_abs(self.integral + increment, MOST_INTEGRAL);
        let acceleration_mps2 =
            per_climb_per_s * wanted_mps + DAMPING_PER_S * (mean_mps - estimate.airspeed_mps);
        let throttle = level + self.integral + config.throttle_per_mps2 * acceleration_mps2;
        (limit(throttle, 0.0, 1.0), wanted_mps)
    }
}
