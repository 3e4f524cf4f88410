//! Whether innovations of the velocity went in one direction before they were refused.
//!
//! A gyroscope whose bias has jumped tips the horizon more and more, and turns gravity into a
//! velocity that grows; a receiver that is wrong all at once does not.

use nalgebra::Vector2;

use super::parameters as p;
use fcc_core::framework::Time;

/// The innovations of the latest second that were believed: their sum, north and east, and its
/// variance on either axis if they are white.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Trend {
    sum: Vector2<f64>,
    variance: f64,
    last: Time,
}

impl Trend {
    /// Takes an innovation that is believed, and its variance on one axis.
    pub(super) fn add(&mut self, taken: Time, difference: Vector2<f64>, variance: f64) {
        let since_s = taken.since(self.last).as_secs_f64();
        self.last = taken;
        let kept = libm::exp(-since_s / p::TREND_S);
        self.sum = self.sum * kept + difference;
        self.variance = self.variance * kept * kept + variance;
    }

    /// Whether one that is refused goes on in the direction of those before.
    pub(super) fn leads_to(&self, difference: Vector2<f64>) -> bool {
        let along = self.sum.dot(&difference.normalize());
        along > 0.0 && along * along > p::SUM_GATE * self.variance
    }
}
