//! How much the velocities of a receiver scatter, whatever it says of that.
//!
//! By second differences of what they differ by from the filter's: an error of the filter, or of
//! a receiver, that grows steadily is none of their noise.

use nalgebra::Vector3;

use fcc_core::blocks::smoothing_factor;
use fcc_core::framework::Time;

/// The scatter is that of this time, s. In one fix its square grows by no more than by this
/// factor of it: a jump is no noise.
const LASTS_S: f64 = 2.0;
const MOST: f64 = 6.0;

/// The scatter of the latest seconds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Scatter {
    last: [Vector3<f64>; 2],
    taken: Time,
    variance: f64,
}

impl Scatter {
    /// Takes by how much a velocity differs from the filter's, m/s, and the variance that one
    /// axis has at least. What it has by the scatter.
    pub(super) fn variance(&mut self, taken: Time, difference: Vector3<f64>, least: f64) -> f64 {
        let [last, before] = self.last;
        self.last = [difference, last];
        let since_s = taken.since(self.taken).as_secs_f64().min(1.0);
        self.taken = taken;
        self.variance = self.variance.max(least);
        // Of three axes, each 1, -2, 1 times its noise.
        let square = (difference - 2.0 * last + before).norm_squared() / 18.0;
        let share = smoothing_factor(since_s, LASTS_S);
        self.variance += (square.min(MOST * self.variance) - self.variance) * share;
        self.variance.max(least)
    }
}
