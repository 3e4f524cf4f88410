//! The grid of deadlines and a timer's position on it.
//!
//! Every timer has the kernel wake it at [`Deadlines::alarm_ns`] and passes the
//! wake-up to [`Deadlines::woken`]: numbers, due times and misses are calculated
//! here only, from the clock.

use nix::errno::Errno;
use nix::sys::time::TimeValLike as _;
use nix::time::{ClockId, clock_gettime};
use std::io;
use std::time::Duration;

use crate::{Expiry, Relief, TimerError};

/// Below this, the wake-up alone takes longer than the period.
const SHORTEST_PERIOD: Duration = Duration::from_micros(10);
/// Longer is not a control loop; also keeps nanoseconds far from overflow.
const LONGEST_PERIOD: Duration = Duration::from_secs(3600);

/// The time that a thread may be awake for each unit that it sleeps: 95 % to 5 %.
const AWAKE_FOR_EACH_ASLEEP: u64 = 19;

/// A period known to be within the range that timers serve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Period(Duration);

impl Period {
    pub(crate) fn new(period: Duration) -> Result<Self, TimerError> {
        if (SHORTEST_PERIOD..=LONGEST_PERIOD).contains(&period) {
            Ok(Self(period))
        } else {
            Err(TimerError::Period(period))
        }
    }

    pub(crate) const fn duration(self) -> Duration {
        self.0
    }

    pub(crate) const fn ns(self) -> i64 {
        self.0.as_nanos() as i64
    }
}

/// Deadlines at `start + n * period`, and the last one served.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deadlines {
    start_ns: i64,
    period_ns: i64,
    served: u64,
    early_ns: i64,
}

impl Deadlines {
    pub(crate) const fn new(start_ns: i64, period: Period) -> Self {
        Self {
            start_ns,
            period_ns: period.ns(),
            served: 0,
            early_ns: 0,
        }
    }

    /// Sets how long before its deadlines the kernel wakes the thread.
    pub(crate) const fn wake_early(&mut self, margin_ns: i64) {
        self.early_ns = margin_ns;
    }

    /// The number of the next deadline.
    pub(crate) const fn next(&self) -> u64 {
        self.served.saturating_add(1)
    }

    /// When a deadline is due, ns on the clock that `start_ns` was read from.
    pub(crate) const fn due_ns(&self, number: u64) -> i64 {
        self.start_ns
            .saturating_add(self.period_ns.saturating_mul(number as i64))
    }

    /// When the kernel wakes the thread for the next deadline: at the deadline,
    /// or earlier by the margin.
    pub(crate) const fn alarm_ns(&self) -> i64 {
        self.due_ns(self.next()).saturating_sub(self.early_ns)
    }

    /// How much time since the last deadline served has been used at `now_ns`.
    pub(crate) fn used_ns(&self, now_ns: i64) -> u64 {
        let since_ns = now_ns.saturating_sub(self.due_ns(self.served));
        since_ns.max(0).unsigned_abs()
    }

    /// When the deadline is due that a wait which begins now ends at: the next,
    /// or the first that leaves enough time to others.
    pub(crate) fn awaited_ns(&self, now_ns: i64, relief: Relief) -> i64 {
        let next_ns = self.due_ns(self.next());
        if relief != Relief::Skip {
            return next_ns;
        }
        let rest_ns = (self.used_ns(now_ns) / AWAKE_FOR_EACH_ASLEEP) as i64;
        let missing_ns = now_ns.saturating_add(rest_ns).saturating_sub(next_ns);
        let skipped = missing_ns
            .max(0)
            .unsigned_abs()
            .div_ceil(self.period_ns.unsigned_abs());
        self.due_ns(self.next().saturating_add(skipped))
    }

    /// Serves the latest deadline, which the clock has reached. To be called as
    /// soon as the kernel has woken the thread.
    pub(crate) fn woken(&mut self, woke_ns: i64) -> Expiry {
        let since_start = woke_ns.saturating_sub(self.start_ns).max(0).unsigned_abs();
        let latest = since_start / self.period_ns.unsigned_abs();
        let passed = latest.saturating_sub(self.served).max(1);
        self.served = self.served.saturating_add(passed);
        let scheduled_ns = self.due_ns(self.served);
        Expiry {
            number: self.served,
            scheduled_ns,
            woke_ns,
            missed: passed.saturating_sub(1),
            early_wake_ns: 0,
            spun_ns: 0,
            kernel_lateness_ns: woke_ns.saturating_sub(scheduled_ns),
            used_ns: 0,
        }
    }
}

/// Now on `CLOCK_MONOTONIC`, ns. It is read without a system call.
pub(crate) fn monotonic_ns() -> i64 {
    // Linux always has this clock, so the call cannot fail.
    clock_gettime(ClockId::CLOCK_MONOTONIC).map_or(0, |now| now.num_nanoseconds())
}

/// A time or duration in the kernel's format. Negative becomes 0.
pub(crate) fn timespec(ns: i64) -> nix::sys::time::TimeSpec {
    Duration::from_nanos(u64::try_from(ns).unwrap_or(0)).into()
}

/// Makes an error from the system's answer to `call`.
pub(crate) fn os_error(call: &'static str) -> impl FnOnce(Errno) -> TimerError {
    move |errno| TimerError::Os {
        call,
        source: io::Error::from(errno),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every_25_ms() -> Deadlines {
        Deadlines::new(
            1_000_000_000,
            Period::new(Duration::from_millis(25)).unwrap(),
        )
    }

    #[test]
    fn forty_deadlines_of_25_ms_are_one_second() {
        assert_eq!(every_25_ms().due_ns(40), 2_000_000_000);
    }

    #[test]
    fn a_wake_up_three_and_a_half_periods_on_serves_the_third_deadline() {
        let mut deadlines = every_25_ms();
        let expiry = deadlines.woken(1_087_500_000);
        assert_eq!(expiry.number, 3);
        assert_eq!(expiry.missed, 2);
        assert_eq!(expiry.scheduled_ns, 1_075_000_000);
        assert_eq!(deadlines.alarm_ns(), 1_100_000_000);
    }

    #[test]
    fn the_alarm_comes_the_margin_before_the_deadline() {
        let mut deadlines = every_25_ms();
        deadlines.wake_early(200_000);
        assert_eq!(deadlines.alarm_ns(), 1_024_800_000);
        assert_eq!(deadlines.due_ns(deadlines.next()), 1_025_000_000);
    }

    #[test]
    fn a_wake_up_at_the_deadline_is_on_time() {
        let on_time = every_25_ms().woken(1_025_000_000);
        assert_eq!((on_time.number, on_time.missed), (1, 0));
        assert_eq!(on_time.lateness_ns(), 0);
    }

    #[test]
    fn a_passed_deadline_is_skipped_only_to_relieve_others() {
        // 1.2 periods after the deadline served, which is number 0.
        let deadlines = every_25_ms();
        let now_ns = 1_030_000_000;
        assert_eq!(deadlines.used_ns(now_ns), 30_000_000);
        for relief in [Relief::None, Relief::NoSpin] {
            assert_eq!(deadlines.awaited_ns(now_ns, relief), 1_025_000_000);
        }
        assert_eq!(deadlines.awaited_ns(now_ns, Relief::Skip), 1_050_000_000);
    }

    #[test]
    fn at_least_a_twentieth_of_the_time_is_slept() {
        let deadlines = every_25_ms();
        // 47.5 ms are 95 % of two periods; a millisecond more needs a third.
        for (used_ns, periods) in [
            (1_000_000, 1),
            (23_750_000, 1),
            (23_800_000, 2),
            (47_500_000, 2),
            (48_500_000, 3),
            (237_500_000, 10),
        ] {
            assert_eq!(
                deadlines.awaited_ns(1_000_000_000 + used_ns, Relief::Skip),
                1_000_000_000 + 25_000_000 * periods,
                "{used_ns}"
            );
        }
    }

    #[test]
    fn periods_beyond_what_can_be_timed_are_refused() {
        for bad in [
            Duration::ZERO,
            Duration::from_nanos(9_999),
            Duration::from_nanos(3_600_000_000_001),
            Duration::MAX,
        ] {
            assert!(
                matches!(Period::new(bad), Err(TimerError::Period(_))),
                "{bad:?}"
            );
        }
        assert_eq!(Period::new(Duration::from_micros(10)).unwrap().ns(), 10_000);
        assert_eq!(
            Period::new(Duration::from_secs(3600)).unwrap().ns(),
            3_600_000_000_000
        );
    }

    #[test]
    fn the_grid_does_not_drift_when_the_period_is_not_whole() {
        // 60 Hz rounded to nanoseconds, for an hour: 216000 x 16666667 ns.
        let period = Period::new(Duration::from_nanos(16_666_667)).unwrap();
        assert_eq!(Deadlines::new(0, period).due_ns(216_000), 3_600_000_072_000);
    }
}
