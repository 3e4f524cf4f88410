//! The altitude at a past instant, refined by later measurements.

use super::vertical_covariance::{CrossCovariance, Gains, VerticalCovariance};

/// The altitude at a past instant, and its covariance with the present state (a
/// fixed-point smoother, Gelb 1974, section 5.3).
#[derive(Clone, Copy, Debug)]
pub(super) struct MarkedAltitude {
    altitude_m: f64,
    link: CrossCovariance,
}

impl MarkedAltitude {
    /// The present altitude, of a filter with this covariance.
    pub(super) const fn new(altitude_m: f64, covariance: &VerticalCovariance) -> Self {
        Self {
            altitude_m,
            link: covariance.of_altitude(),
        }
    }

    /// As now known, m.
    pub(super) const fn altitude_m(self) -> f64 {
        self.altitude_m
    }

    /// As [`VerticalCovariance::predict`].
    pub(super) fn predict(&mut self, measured: bool, dt_s: f64) {
        self.link.predict(measured, dt_s);
    }

    /// By the filter's correction with an altitude that differs by `error_m`.
    pub(super) fn correct(&mut self, gains: &Gains, error_m: f64) {
        self.altitude_m += self.link.correct(gains) * error_m;
    }

    /// It is kept unchanged: later measurements say no more of it.
    pub(super) fn keep(&mut self) {
        self.link = CrossCovariance::default();
    }
}
