//! One turn of the loop.

use core::time::Duration;

use super::Time;
use crate::schema;

schema! {
    /// One turn of the loop: its number and its times. All that code inside a tick
    /// knows of time, it knows from here.
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
        /// Periods that passed unserved right before this tick.
        #[field(4)]
        pub missed: u64,
        /// Seconds since the tick before, by schedule: the period, times one more
        /// than the missed. Positive.
        #[field(5)]
        pub dt_s: f64,
    }
    /// How late the loop woke.
    #[field(6)]
    derived lateness_ns = |tick| (tick.woke - tick.scheduled) as f64;
}

impl Tick {
    /// How late the loop woke: `woke - scheduled`.
    pub const fn lateness(&self) -> Duration {
        self.woke.since(self.scheduled)
    }
}
