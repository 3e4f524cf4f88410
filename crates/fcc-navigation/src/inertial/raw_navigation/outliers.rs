//! Single readings of an inertial sensor that no aircraft makes, as a bus under interference
//! gives: taken as if they had not arrived, before the control loops and the filter see them.

use crate::PlausibilityLimit;
use fcc_core::framework::Time;

/// So many in a row may be wrong; the next one is believed, whatever it is.
const IN_A_ROW: u8 = 2;
/// So many readings are averaged; if more than this share of them is far from those before
/// it is vibration, of which every reading counts.
const READINGS: f64 = 200.0;
const SELDOM: f64 = 0.2;

/// Follows the readings of one sensor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outliers {
    limit: &'static PlausibilityLimit,
    /// The last one that could be true, and the last one.
    good: (Time, [f64; 3]),
    last: (Time, [f64; 3]),
    in_a_row: u8,
    share: f64,
}

impl Outliers {
    /// Of a sensor whose readings change by no more than this.
    pub(super) const fn beyond(limit: &'static PlausibilityLimit) -> Self {
        Self {
            limit,
            good: (Time::NEVER, [0.0; 3]),
            last: (Time::NEVER, [0.0; 3]),
            in_a_row: 0,
            share: 0.0,
        }
    }

    /// Whether a reading is one: far from the last that was not, and from the one before it,
    /// which may have been the first after a step. Call it for each; a repeated one is none.
    pub(super) fn is_one(&mut self, taken: Time, reading: [f64; 3]) -> bool {
        if taken <= self.last.0 {
            return false;
        }
        let follows = |(then, before): (Time, [f64; 3])| {
            let gap_s = taken.since(then).as_secs_f64();
            self.limit.holds_each(before, reading, gap_s)
        };
        let is_far = !self.good.0.is_never() && !follows(self.good) && !follows(self.last);
        self.last = (taken, reading);
        self.share += (f64::from(u8::from(is_far)) - self.share) / READINGS;
        let is_one = is_far && self.in_a_row < IN_A_ROW && self.share < SELDOM;
        if is_one {
            self.in_a_row += 1;
        } else {
            self.good = self.last;
            self.in_a_row = 0;
        }
        is_one
    }
}

#[cfg(test)]
mod tests {
    use core::time::Duration;

    use super::*;
    use crate::{RATES_RADPS, SPECIFIC_FORCE_MPS2};

    /// Which of some readings of the first axis, 25 ms apart, are left out.
    fn left_out<const N: usize>(
        limit: &'static PlausibilityLimit,
        readings: [f64; N],
    ) -> [bool; N] {
        let mut outliers = Outliers::beyond(limit);
        let mut taken = Time::from_nanos(0);
        readings.map(|reading| {
            taken = taken + Duration::from_millis(25);
            outliers.is_one(taken, [reading, 0.0, 0.0])
        })
    }

    #[test]
    fn single_readings_that_no_aircraft_makes_are_left_out() {
        let hit = left_out(&RATES_RADPS, [0.1, 0.2, 10.0, 0.3, -34.9, 30.0, 0.4]);
        assert_eq!(hit, [false, false, true, false, true, true, false]);
        let hit = left_out(&SPECIFIC_FORCE_MPS2, [1.0, 156.0, 2.0, -156.0, 0.0]);
        assert_eq!(hit, [false, true, false, true, false]);
    }

    /// The quickest roll of an aerobatic aircraft: 400 °/s (Extra 300L) within 0.2 s, 35 rad/s²;
    /// a step, of which only the first reading waits for the next; a hard landing, 3 g at once.
    #[test]
    fn what_goes_on_is_believed() {
        let roll: [f64; 40] = core::array::from_fn(|at| (0.875 * at as f64).min(7.0));
        assert_eq!(left_out(&RATES_RADPS, roll), [false; 40]);
        let step = left_out(&RATES_RADPS, [0.0, 0.0, 5.0, 5.1, 5.0]);
        assert_eq!(step, [false, false, true, false, false]);
        let landing = [-9.8, -39.2, -20.0, -9.8];
        assert_eq!(left_out(&SPECIFIC_FORCE_MPS2, landing), [false; 4]);
    }

    #[test]
    fn of_vibration_most_readings_count() {
        let shaken: [f64; 2_000] = core::array::from_fn(|at| [0.0, 4.0, -4.0, 2.0][at % 4]);
        let left = left_out(&RATES_RADPS, shaken)
            .iter()
            .filter(|is| **is)
            .count();
        assert!(left <= 500, "{left}");
    }
}
