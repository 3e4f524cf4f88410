//! The altitude captured at engagement, which is refined by later measurements.

use fcc_core::blocks::limit_abs;

/// The limit of later corrections of the captured altitude, m: a barometer that
/// jumps after engagement must not move the set point.
const MAX_SHIFT_M: f64 = 1.0;

/// The altitude captured at engagement, which is refined by later measurements:
/// the set point follows, by some tens of centimetres in the first seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capture {
    captured_m: f64,
    shifted_m: f64,
}

impl Capture {
    /// Starts with the altitude as estimated at engagement.
    pub(super) const fn of(altitude_m: f64) -> Self {
        Self {
            captured_m: altitude_m,
            shifted_m: 0.0,
        }
    }

    /// The change of the set point, given the present estimate of the altitude
    /// at engagement.
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
    fn the_set_point_follows_the_refined_altitude() {
        let mut capture = Capture::of(900.0);
        let moved: f64 = [900.1, 900.15, 900.12]
            .into_iter()
            .map(|known| capture.shift_m(known))
            .sum();
        assert!((moved - 0.12).abs() < 1e-9);
    }

    #[test]
    fn a_jump_of_the_barometer_does_not_move_the_set_point() {
        let mut capture = Capture::of(900.0);
        assert!((capture.shift_m(950.0) - MAX_SHIFT_M).abs() < 1e-9);
        assert!((capture.shift_m(900.0) + MAX_SHIFT_M).abs() < 1e-9);
    }
}
