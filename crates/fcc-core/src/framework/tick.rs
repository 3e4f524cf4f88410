//! One pass through the loop.

use core::time::Duration;

use libm::round;

use super::Time;
use crate::schema;

schema! {
    /// One pass through the loop: its number and its times. Code inside a tick
    /// has no other source of time.
    ///
    /// ```
    /// use core::time::Duration;
    /// use fcc_core::framework::{Tick, Time};
    ///
    /// let tick = Tick {
    ///     scheduled: Time::from_nanos(25_000_000),
    ///     woke: Time::from_nanos(25_060_000),
    ///     dt_s: 0.025,
    ///     ..Tick::default()
    /// };
    /// assert_eq!(tick.lateness(), Duration::from_micros(60));
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Tick {
        /// Counts periods, the first after the loop's start being 1; a missed
        /// period is counted too, so a gap in the numbers is a gap in time.
        #[field(1, column = "tick")]
        pub number: u64,
        /// When the tick was due.
        #[field(2)]
        pub scheduled: Time,
        /// When the loop woke for it.
        #[field(3)]
        pub woke: Time,
        /// Periods missed directly before this tick.
        #[field(4)]
        pub missed: u64,
        /// Seconds since the previous tick, by schedule: the period times one
        /// more than the missed periods. Positive.
        #[field(5)]
        pub dt_s: f64,
    }
    /// How late the loop woke for the first period that it served or missed.
    #[field(6)]
    derived lateness_ns = |tick| (tick.woke - tick.scheduled) as f64 + tick.missed_ns();
}

impl Tick {
    /// How late the loop woke: `woke - scheduled`, and the periods missed before.
    pub fn lateness(&self) -> Duration {
        let missed = Duration::from_nanos(self.missed_ns() as u64);
        self.woke.since(self.scheduled).saturating_add(missed)
    }

    fn missed_ns(&self) -> f64 {
        let missed = self.missed as f64;
        round(missed / (missed + 1.0) * self.dt_s * 1e9)
    }
}
