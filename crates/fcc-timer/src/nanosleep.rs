//! A timer that sleeps: `clock_nanosleep(2)` to absolute deadlines.

use nix::errno::Errno;
use nix::time::{ClockId, ClockNanosleepFlags, clock_nanosleep};
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns, os_error, timespec};
use crate::early::{Alarm, Early};
use crate::{EarlyWake, Expiry, Timer, TimerError, Wake};

/// A periodic timer made of sleeps. Nothing runs in the kernel between two
/// waits, so passed deadlines are calculated from the clock. It is the only
/// timer here that the timer slack delays if the thread is not real-time.
#[derive(Debug)]
pub struct Nanosleep {
    period: Period,
    deadlines: Option<Deadlines>,
    early: Option<Early>,
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
            early: None,
        })
    }

    /// Makes it wake early and spin until its deadlines.
    ///
    /// # Errors
    /// When a value is out of its range.
    pub fn waking_early(mut self, early: &EarlyWake) -> Result<Self, TimerError> {
        self.early = Some(Early::new(early, self.period)?);
        Ok(self)
    }
}

impl Timer for Nanosleep {
    fn start(&mut self) -> Result<(), TimerError> {
        let deadlines = Early::grid(self.early.as_mut(), self.period);
        self.deadlines = Some(deadlines);
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        let deadlines = self.deadlines.as_mut().ok_or(TimerError::NotStarted)?;
        if let Some(early) = &mut self.early {
            return early.wait(deadlines, &mut Sleep);
        }
        let alarm_ns = deadlines.alarm_ns();
        loop {
            Sleep.sleep_until(alarm_ns)?;
            let woke_ns = monotonic_ns();
            if woke_ns >= alarm_ns {
                return Ok(deadlines.woken_uncounted(woke_ns));
            }
        }
    }

    fn wait_or_warm_up(&mut self) -> Result<Wake, TimerError> {
        match (&mut self.early, &mut self.deadlines) {
            (Some(early), Some(deadlines)) => early.wait_or_warm_up(deadlines, &mut Sleep),
            _ => self.wait().map(Wake::Deadline),
        }
    }

    fn disable_early_wake(&mut self) {
        self.early = None;
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

/// A sleep has no kernel timer to set.
#[derive(Debug)]
struct Sleep;

impl Alarm for Sleep {
    fn move_to(&mut self, _: i64) -> Result<(), TimerError> {
        Ok(())
    }

    fn sleep_until(&mut self, alarm_ns: i64) -> Result<(), TimerError> {
        let alarm = timespec(alarm_ns);
        loop {
            // A time in the past returns at once; an absolute time survives
            // any number of interruptions without drifting.
            match clock_nanosleep(
                ClockId::CLOCK_MONOTONIC,
                ClockNanosleepFlags::TIMER_ABSTIME,
                &alarm,
            ) {
                Ok(_) => return Ok(()),
                Err(Errno::EINTR) => {}
                Err(errno) => return Err(os_error("clock_nanosleep")(errno)),
            }
        }
    }
}
