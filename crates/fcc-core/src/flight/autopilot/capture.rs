//! The altitude captured at engagement, which is known better a little later.

use crate::blocks::limit_abs;

/// What is learnt later moves the captured altitude by no more than this, m:
/// a barometer that jumps after engagement must not move the set point along.
const MAX_SHIFT_M: f64 = 1.0;

/// The altitude captured at engagement, which is known better a little later:
/// the set point follows, by some tens of centimetres in the first seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capture {
    captured_m: f64,
    shifted_m: f64,
}

impl Capture {
    /// Engaged at this altitude, as known then.
    pub(super) const fn of(altitude_m: f64) -> Self {
        Self {
            captured_m: altitude_m,
            shifted_m: 0.0,
        }
    }

    /// By how much the set point has to move, given what is known by now of
    /// the altitude at engagement.
    pub(super) fn shift_m(&mut self, altitude_m: f64) -> f64 {
        let shift_m = limit_abs(altitude_m - self.captured_m, MAX_SHIFT_M);
        let by_m = shift_m - self.shifted_m;
        self.shifted_m = shift_m;
        by_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_set_point_follows_what_is_learnt() {
        let mut capture = Capture::of(900.0);
        let moved: f64 = [900.1, 900.15, 900.12]
            .into_iter()
            .map(|known| capture.shift_m(known))
            .sum();
        assert!((moved - 0.12).abs() < 1e-9);
    }

    #[test]
    fn a_barometer_that_jumps_does_not_take_the_set_point_along() {
        let mut capture = Capture::of(900.0);
        assert!((capture.shift_m(950.0) - MAX_SHIFT_M).abs() < 1e-9);
        assert!((capture.shift_m(900.0) + MAX_SHIFT_M).abs() < 1e-9);
    }
}
