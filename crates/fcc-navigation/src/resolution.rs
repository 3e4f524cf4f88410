//! The resolution of a sensor, as its readings show it.

use fcc_core::framework::{Reading, Time};

/// After this many equal readings in a row a sensor counts as coarse: one with
/// noise or a fine resolution does not repeat a value so often in flight.
const FEWEST_REPEATS: u32 = 8;

/// The resolution of a sensor: the smallest change of its readings so far. Until
/// they have changed it may be as coarse as the coarsest that is flown.
///
/// The true value is within half a step of a reading. When the reading changes,
/// it is at the edge between the two, so that moment says more than all readings
/// between two changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resolution {
    coarsest: f64,
    smallest: f64,
    last: Reading<f64>,
    repeats: u32,
    is_coarse: bool,
}

impl Resolution {
    /// Of a sensor whose steps are at most `coarsest`, in the unit of its
    /// readings.
    pub(super) const fn new(coarsest: f64) -> Self {
        Self {
            coarsest,
            smallest: coarsest,
            last: Reading::new(0.0, Time::NEVER),
            repeats: 0,
            is_coarse: false,
        }
    }

    /// Takes a new reading; returns by how much it differs from the previous one,
    /// as `difference` computes it.
    pub(super) fn take(
        &mut self,
        reading: &Reading<f64>,
        difference: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        if self.last.is_never() || reading.source != self.last.source {
            *self = Self::new(self.coarsest);
            self.last = *reading;
            return 0.0;
        }
        let change = difference(reading.value, self.last.value);
        self.last = *reading;
        if change == 0.0 {
            self.repeats = self.repeats.saturating_add(1);
            self.is_coarse |= self.repeats >= FEWEST_REPEATS;
        } else {
            self.repeats = 0;
            self.smallest = self.smallest.min(change.abs());
        }
        change
    }

    /// The step of a coarse sensor; 0 of one whose readings do not repeat.
    pub(super) const fn step(&self) -> f64 {
        if self.is_coarse { self.smallest } else { 0.0 }
    }

    /// The smallest change so far, however seldom readings repeat.
    pub(super) const fn smallest(&self) -> f64 {
        self.smallest
    }

    /// How far a value is from the nearest one at which a reading that differs
    /// from it by `error` can have been taken: 0 within half a step.
    pub(super) fn beyond(&self, error: f64) -> f64 {
        let half = 0.5 * self.step();
        error - error.clamp(-half, half)
    }

    /// How far a value is from the edge at which the reading changed by
    /// `change`, if it differs from the new reading by `error`.
    pub(super) const fn error_from_edge(&self, error: f64, change: f64) -> f64 {
        error - (0.5 * self.step()).copysign(change)
    }
}

/// The resolutions that navigation has learned.
#[derive(Clone, Copy, Debug)]
pub struct Resolutions {
    /// The smallest change of the heading, rad.
    pub heading_rad: f64,
    /// The smallest change of the airspeed, m/s.
    pub airspeed_mps: f64,
    /// By how much the altitude of a coarse sensor changes at once, m; 0 of a
    /// fine one.
    pub altitude_step_m: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_core::units::FOOT_M;

    fn learn(values: impl IntoIterator<Item = f64>) -> Resolution {
        let mut resolution = Resolution::new(100.0 * FOOT_M);
        for (n, value) in (1..).zip(values) {
            let reading = Reading::new(value, Time::from_nanos(n * 25_000_000));
            resolution.take(&reading, |is, was| is - was);
        }
        resolution
    }

    #[test]
    fn a_step_is_learned_from_the_first_change() {
        let climbing = |n: i32| f64::from(n / 40) * 20.0 * FOOT_M;
        assert!((learn((0..30).map(climbing)).step() - 100.0 * FOOT_M).abs() < 1e-9);
        assert!((learn((0..90).map(climbing)).step() - 20.0 * FOOT_M).abs() < 1e-9);
    }

    #[test]
    fn a_fine_sensor_has_no_step() {
        let climbing = |n: i32| 900.0 + f64::from(n) * 0.05;
        let fine = learn((0..90).map(climbing));
        assert_eq!(fine.step(), 0.0);
        // One that hangs afterwards is as fine as it was.
        let hung = learn((0..90).map(|n| climbing(n.min(30))));
        assert!((hung.step() - 0.05).abs() < 1e-9);
    }

    #[test]
    fn the_edge_is_half_a_step_before_the_new_reading() {
        let resolution = learn((0..90).map(|n| f64::from(n / 40) * 10.0));
        // 14 with readings from 10 to 20: the edge is at 15.
        assert!((resolution.error_from_edge(20.0 - 14.0, 10.0) - 1.0).abs() < 1e-9);
        assert!((resolution.error_from_edge(10.0 - 14.0, -10.0) - 1.0).abs() < 1e-9);
        assert_eq!(resolution.beyond(4.9), 0.0);
        assert!((resolution.beyond(-6.0) + 1.0).abs() < 1e-9);
    }
}
