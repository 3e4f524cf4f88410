//! Other inertial sensors than before; without gyroscopes: attitude by the magnetic field,
//! receiver and airspeed.

use super::filter::{ATTITUDE, FORCE_BIAS, Filter, RATE_BIAS, VELOCITY};
use super::parameters as p;

/// What wrong gyroscopes have left of the attitude, rad² (23°), and of the velocity,
/// m²/s².
const LEFT_OF_ATTITUDE: f64 = 0.16;
const LEFT_OF_VELOCITY: f64 = 9.0;

impl Filter {
    /// Begins to take how the field turns for rates, or ends to. The bias of either
    /// is none of the other, and the field corrects the horizon, too: an error of it
    /// is small against what gyroscopes have left.
    pub(super) fn turn_by_field(&mut self, turns_by_field: bool) {
        self.change_gyroscopes();
        self.turns_by_field = turns_by_field;
        if turns_by_field {
            self.reset_covariance(ATTITUDE, 3, LEFT_OF_ATTITUDE);
            self.add_variance(VELOCITY, 3, LEFT_OF_VELOCITY);
        }
    }

    /// The bias of other gyroscopes is not known.
    pub(super) fn change_gyroscopes(&mut self) {
        self.settle();
        self.rate_bias.fill(0.0);
        self.reset_covariance(RATE_BIAS, 3, p::RATE_BIAS * p::RATE_BIAS);
    }

    /// Nor that of other accelerometers.
    pub(super) fn change_accelerometers(&mut self) {
        self.settle();
        self.force_bias.fill(0.0);
        self.reset_covariance(FORCE_BIAS, 3, p::FORCE_BIAS * p::FORCE_BIAS);
    }
}
