//! The demand for throttle at the present airspeed and bank.

use libm::cos;

use super::Autopilot;
use crate::control::ThrottleDemand;

impl Autopilot {
    /// What the throttle is to do for the commanded airspeed and a climb rate.
    pub(super) fn throttle_demand(&self, climb_rate_mps: f64) -> ThrottleDemand {
        let estimate = self.estimator.estimate();
        ThrottleDemand {
            airspeed_mps: self
                .envelope()
                .least_target_mps(estimate)
                .max(self.flyable_airspeed_mps(self.guidance.targets.airspeed_mps)),
            climb_rate_mps,
            load_factor: 1.0 / cos(estimate.roll_rad).max(0.5),
            least_throttle: self
                .envelope()
                .least_throttle(estimate.airspeed_mps)
                .max(self.loops.altitude.least_throttle()),
        }
    }
}
