//! Waking early, and spinning to the deadline.
//!
//! A kernel wakes a thread some tens of microseconds after the requested time,
//! and the delay varies: the interrupt, the scheduler and the exit from an idle
//! state take time. A timer that requests its wake-up a margin before the
//! deadline, and then reads the clock until the deadline is reached, is late by
//! one reading of the clock, if the margin was long enough.
//!
//! The required margin is measured ([`margin`]); its cost is limited
//! ([`EarlyWake`]). The grid is placed so that no kernel tick falls between
//! wake-up and deadline ([`kernel_tick`]), and the rest of the margin is used to
//! load the caches for the tick ([`warm_up`]). The three kernel timers share
//! this code: each implements [`Alarm`], and [`Early::wait_or_warm_up`] waits
//! for all of them.

mod config;
mod kernel_tick;
mod margin;
mod warm_up;

use crate::deadlines::{Deadlines, Period, monotonic_ns};
use crate::{Expiry, TimerError, Wake};
pub use config::EarlyWake;
use kernel_tick::KernelTick;
use margin::Margin;
use warm_up::WarmUp;

/// How one kind of timer has the kernel wake the thread.
pub(crate) trait Alarm {
    /// Sets the next alarm to `alarm_ns`, and the following ones a period apart
    /// from there.
    fn move_to(&mut self, alarm_ns: i64) -> Result<(), TimerError>;

    /// Sleeps until the next alarm. May return before `alarm_ns`, for an earlier
    /// alarm that nothing waited for.
    fn sleep_until(&mut self, alarm_ns: i64) -> Result<(), TimerError>;
}

/// The state of a timer that wakes early.
#[derive(Debug)]
pub(crate) struct Early {
    margin: Margin,
    warm_up: WarmUp,
    /// The wake-up, during a warm-up.
    awake: Option<Awake>,
}

/// A thread that is awake before its deadline.
#[derive(Clone, Copy, Debug)]
struct Awake {
    since_ns: i64,
    /// [`Expiry::used_ns`].
    used_ns: u64,
    /// How late the kernel woke it; `None` if it did not sleep.
    kernel_lateness_ns: Option<i64>,
}

impl Early {
    /// # Errors
    /// When a value is out of its range.
    pub(crate) fn new(config: &EarlyWake, period: Period) -> Result<Self, TimerError> {
        config.check()?;
        Ok(Self {
            margin: Margin::new(config, period.ns()),
            warm_up: WarmUp::new(),
            awake: None,
        })
    }

    /// The grid of a timer that starts now. With early wake it starts up to one
    /// kernel tick later, if that keeps kernel ticks out of the margin; finding
    /// them takes three ticks, six at most.
    pub(crate) fn grid(early: Option<&mut Self>, period: Period) -> Deadlines {
        let Some(early) = early else {
            return Deadlines::new(monotonic_ns(), period);
        };
        early.awake = None;
        let tick = KernelTick::find();
        let now_ns = monotonic_ns();
        let start_ns = tick.map_or(now_ns, |tick| {
            tick.clear_start_ns(now_ns, period.ns(), early.margin.longest_ns())
        });
        let mut deadlines = Deadlines::new(start_ns, period);
        deadlines.wake_early(early.margin.ns());
        deadlines
    }

    /// Waits are continued after some without early wake; returns the margin.
    pub(crate) const fn interrupted(&mut self) -> i64 {
        self.awake = None;
        self.margin.ns()
    }

    /// Waits for the next deadline, without a warm-up.
    pub(crate) fn wait(
        &mut self,
        deadlines: &mut Deadlines,
        kernel: &mut impl Alarm,
    ) -> Result<Expiry, TimerError> {
        match self.wait_or(false, deadlines, kernel)? {
            Wake::WarmUp(expiry) | Wake::Deadline(expiry) => Ok(expiry),
        }
    }

    /// Waits for the next deadline, or once before it for a warm-up.
    pub(crate) fn wait_or_warm_up(
        &mut self,
        deadlines: &mut Deadlines,
        kernel: &mut impl Alarm,
    ) -> Result<Wake, TimerError> {
        self.wait_or(true, deadlines, kernel)
    }

    /// A warm-up returns by the same instructions as the deadline, so that these
    /// are in the caches as well.
    fn wait_or(
        &mut self,
        may_warm_up: bool,
        deadlines: &mut Deadlines,
        kernel: &mut impl Alarm,
    ) -> Result<Wake, TimerError> {
        let due_ns = deadlines.due_ns(deadlines.next());
        let warmed = self.awake.take();
        let awake = if let Some(awake) = warmed {
            let took_ns = monotonic_ns().saturating_sub(awake.since_ns);
            let left_ns = due_ns.saturating_sub(awake.since_ns);
            self.warm_up.took(took_ns, left_ns);
            awake
        } else {
            self.wake(may_warm_up, deadlines, kernel)?
        };
        // A thread that did not sleep has warm caches.
        let warms_up = may_warm_up
            && warmed.is_none()
            && awake.kernel_lateness_ns.is_some()
            && self.warm_up.fits(due_ns.saturating_sub(awake.since_ns));
        let mut served = *deadlines;
        let expiry = spin(&mut served, if warms_up { i64::MIN } else { due_ns });
        let expiry = Expiry {
            early_wake_ns: self.margin.ns().unsigned_abs(),
            // Time after the deadline is not spent spinning.
            spun_ns: due_ns.saturating_sub(awake.since_ns).max(0).unsigned_abs(),
            kernel_lateness_ns: awake
                .kernel_lateness_ns
                .unwrap_or(expiry.kernel_lateness_ns),
            used_ns: awake.used_ns,
            ..expiry
        };
        if warms_up {
            self.awake = Some(awake);
            return Ok(Wake::WarmUp(expiry));
        }
        *deadlines = served;
        Ok(Wake::Deadline(expiry))
    }

    /// Sleeps until the alarm.
    fn wake(
        &mut self,
        may_warm_up: bool,
        deadlines: &mut Deadlines,
        kernel: &mut impl Alarm,
    ) -> Result<Awake, TimerError> {
        let warm_up_ns = if may_warm_up {
            self.warm_up.allowance_ns()
        } else {
            0
        };
        if self.margin.review(warm_up_ns) {
            deadlines.wake_early(self.margin.ns());
            // A system call, but at most one in 32 ticks, and before the wait.
            // Setting every alarm would be one in each tick.
            kernel.move_to(deadlines.alarm_ns())?;
        }
        let alarm_ns = deadlines.alarm_ns();
        let mut now_ns = monotonic_ns();
        let used_ns = deadlines.used_ns(now_ns);
        let mut kernel_lateness_ns = None;
        if now_ns < alarm_ns {
            while now_ns < alarm_ns {
                kernel.sleep_until(alarm_ns)?;
                now_ns = monotonic_ns();
            }
            // Only a thread that slept has a wake-up lateness.
            let late_ns = now_ns.saturating_sub(alarm_ns);
            self.margin.observe(late_ns);
            kernel_lateness_ns = Some(late_ns);
        }
        Ok(Awake {
            since_ns: now_ns,
            used_ns,
            kernel_lateness_ns,
        })
    }
}

/// Reads the clock until a time is reached. One function, so that a warm-up
/// runs the same instructions as the deadline.
///
/// Without [`std::hint::spin_loop`]: a hypervisor interprets many of these in a
/// row as a wait for a lock held by another CPU, and schedules something else
/// (pause-loop exiting).
#[inline(never)]
fn spin(deadlines: &mut Deadlines, until_ns: i64) -> Expiry {
    loop {
        let now_ns = monotonic_ns();
        if now_ns >= until_ns {
            return deadlines.woken(now_ns);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    /// A kernel that reports alarms too early, like a timer whose alarms expired
    /// during a long tick.
    struct Impatient {
        stale: u32,
    }

    impl Alarm for Impatient {
        fn move_to(&mut self, _: i64) -> Result<(), TimerError> {
            Ok(())
        }

        fn sleep_until(&mut self, alarm_ns: i64) -> Result<(), TimerError> {
            if self.stale > 0 {
                self.stale -= 1;
            } else {
                let left_ns = alarm_ns.saturating_sub(monotonic_ns()).max(0);
                std::thread::sleep(Duration::from_nanos(left_ns.unsigned_abs()));
            }
            Ok(())
        }
    }

    #[test]
    fn an_alarm_left_over_does_not_serve_a_deadline() {
        // Long, so that the wait begins before the alarm on any machine.
        let period = Period::new(Duration::from_millis(300)).unwrap();
        let mut early = Early::new(&EarlyWake::default(), period).unwrap();
        let mut deadlines = Deadlines::new(monotonic_ns(), period);
        deadlines.wake_early(early.margin.ns());
        let mut kernel = Impatient { stale: 3 };
        let expiry = early.wait(&mut deadlines, &mut kernel).unwrap();
        assert_eq!(kernel.stale, 0);
        assert!(expiry.woke_ns >= expiry.scheduled_ns);
        assert_eq!(expiry.early_wake_ns, 250_000);
        // From the alarm on: first the kernel's lateness, then the spin.
        let late_ns = expiry.kernel_lateness_ns.unsigned_abs();
        assert_eq!(expiry.spun_ns, 250_000_u64.saturating_sub(late_ns));
    }
}
