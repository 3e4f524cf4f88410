//! Other inertial sensors than before; without gyroscopes: attitude by the magnetic field,
//! receiver and airspeed.

use super::filter::Filter;
use super::parameters as p;
use super::states::{ATTITUDE, BODY_FIELD, FORCE_BIAS, RATE_BIAS, VELOCITY};
use fcc_core::framework::Time;
use fcc_core::units::GRAVITY_MPS2;

/// What wrong gyroscopes have left of the attitude, rad² (23°), and of the velocity,
/// m²/s².
const LEFT_OF_ATTITUDE: f64 = 0.16;
const LEFT_OF_VELOCITY: f64 = 9.0;
/// For so long those that are left were wrong unnoticed, s, and this share of an error of
/// the specific force was taken for gravity.
const NOTICED_S: f64 = 1.5;
const TIPPED: f64 = 0.3;

impl Filter {
    /// Begins to take how the field turns for rates, or ends to. The bias of either
    /// is none of the other, and the field corrects the horizon, too: an error of it
    /// is small against what gyroscopes have left.
    pub(super) fn turn_by_field(&mut self, turns_by_field: bool) {
        self.change_gyroscopes(0.0);
        self.turns_by_field = turns_by_field;
        if turns_by_field {
            self.reset_covariance(ATTITUDE, 3, LEFT_OF_ATTITUDE);
            self.add_variance(VELOCITY, 3, LEFT_OF_VELOCITY);
        }
    }

    /// The bias of other gyroscopes is not known, nor what those before have left of the
    /// attitude if their rates differed by so much, rad/s.
    pub(super) fn change_gyroscopes(&mut self, differed: f64) {
        self.settle();
        let turned = differed * NOTICED_S;
        self.add_variance(ATTITUDE, 3, turned * turned);
        self.rate_bias.fill(0.0);
        self.reset_covariance(RATE_BIAS, 3, p::RATE_BIAS * p::RATE_BIAS);
    }

    /// The same of other accelerometers, m/s²: of the velocity, and of the horizon that
    /// followed it.
    pub(super) fn change_accelerometers(&mut self, differed: f64) {
        self.settle();
        let (tipped, moved) = (TIPPED * differed / GRAVITY_MPS2, differed * NOTICED_S);
        self.add_variance(ATTITUDE, 3, tipped * tipped);
        self.add_variance(VELOCITY, 3, moved * moved);
        self.force_bias.fill(0.0);
        self.reset_covariance(FORCE_BIAS, 3, p::FORCE_BIAS * p::FORCE_BIAS);
    }

    /// What of the aircraft's own field another magnetometer shows is not known.
    pub(super) fn change_magnetometer(&mut self) {
        self.settle();
        self.body_field.fill(0.0);
        self.reset_covariance(BODY_FIELD, 3, p::BODY_FIELD * p::BODY_FIELD);
    }

    /// Nor is the bias of another barometer: it is found anew.
    pub(super) fn change_barometer(&mut self) {
        self.tracks.barometer.used = Time::NEVER;
    }
}
