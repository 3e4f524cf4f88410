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
