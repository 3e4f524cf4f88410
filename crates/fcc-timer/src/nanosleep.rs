//! A timer that sleeps: `clock_nanosleep(2)` to absolute deadlines.

use nix::errno::Errno;
use nix::time::{ClockId, ClockNanosleepFlags, clock_nanosleep};
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns, refused, timespec};
use crate::{Expiry, Timer, TimerError};

/// A periodic timer made of sleeps. Nothing runs in the kernel between two
/// waits, so nothing is counted there: the clock tells which deadlines have
/// passed. The only one of the timers that the timer slack makes late when the
/// thread is not real-time.
#[derive(Debug)]
pub struct Nanosleep {
    period: Period,
    deadlines: Option<Deadlines>,
}

impl Nanosleep {
    pub(crate) const NAME: &str = "nanosleep";

    /// Makes a timer, not yet started.
    ///
    /// # Errors
    /// When the period is not between 10 µs and 1 hour.
    pub fn new(period: Duration) -> Result<Self, TimerError> {
        Ok(Self {
            period: Period::new(period)?,
            deadlines: None,
        })
    }
}

impl Timer for Nanosleep {
    fn start(&mut self) -> Result<(), TimerError> {
        self.deadlines = Some(Deadlines::new(monotonic_ns(), self.period));
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        let deadlines = self.deadlines.as_mut().ok_or(TimerError::NotStarted)?;
        let alarm_ns = deadlines.alarm_ns();
        let alarm = timespec(alarm_ns);
        loop {
            // A time in the past returns at once; an absolute time survives
            // any number of interruptions without drifting.
            match clock_nanosleep(
                ClockId::CLOCK_MONOTONIC,
                ClockNanosleepFlags::TIMER_ABSTIME,
                &alarm,
            ) {
                Ok(_) => {
                    let woke_ns = monotonic_ns();
                    if woke_ns >= alarm_ns {
                        return Ok(deadlines.woken_uncounted(woke_ns));
                    }
                }
                Err(Errno::EINTR) => {}
                Err(errno) => return Err(refused("clock_nanosleep")(errno)),
            }
        }
    }

    fn period(&self) -> Duration {
        self.period.duration()
    }

    fn now_ns(&self) -> i64 {
        monotonic_ns()
    }

    fn name(&self) -> &'static str {
        Self::NAME
    }
}
