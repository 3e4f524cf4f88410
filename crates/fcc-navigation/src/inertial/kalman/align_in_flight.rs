//! What the filter does when it is aligned in flight.

use nalgebra::Vector3;

use super::filter::Filter;
use super::in_flight::{LARGEST_FORCE_BIAS, LARGEST_RATE_BIAS, RECEIVER_MPS, credible};
use super::parameters as p;
use super::states::{ATTITUDE, LATENESS, UNKNOWN_ANGLE, VELOCITY};
use fcc_core::framework::Time;

impl Filter {
    /// Takes a receiver's velocity of a time; where the attitude does not explain how it
    /// changed, and another one does, that one is right. Whether it was changed.
    pub(super) fn align_in_flight(&mut self, taken: Time, velocity: Vector3<f64>) -> bool {
        if !self.in_flight.take(taken, velocity) {
            return false;
        }
        let (believed, gravity) = (self.motion.attitude, self.motion.gravity());
        let Some(found) = self.in_flight.other(believed, self.late_s, gravity) else {
            return false;
        };
        self.settle();
        let change = found.velocity - self.motion.velocity;
        self.motion.attitude = found.attitude;
        self.motion.velocity = found.velocity;
        self.path.corrected(Vector3::zeros(), change);
        for axis in 0..3 {
            let variance = found.variance[axis].min(UNKNOWN_ANGLE);
            self.reset_covariance(ATTITUDE + axis, 1, variance);
        }
        self.reset_covariance(VELOCITY, 3, RECEIVER_MPS * RECEIVER_MPS);
        let biases = (
            credible(self.rate_bias, LARGEST_RATE_BIAS),
            credible(self.force_bias, LARGEST_FORCE_BIAS),
        );
        self.change_gyroscopes(0.0);
        self.change_accelerometers(0.0);
        (self.rate_bias, self.force_bias) = biases;
        self.change_magnetometer();
        self.forget_wind();
        self.late_s = found.late_s;
        self.reset_covariance(LATENESS, 1, p::LATENESS * p::LATENESS);
        true
    }
}
