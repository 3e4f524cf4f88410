//! A timer that is read like a file: `timerfd_create(2)`.

use nix::errno::Errno;
use nix::sys::timerfd::{
    ClockId, Expiration, TimerFd as Descriptor, TimerFlags, TimerSetTimeFlags,
};
use nix::unistd::read;
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns, os_error, timespec};
use crate::early::{Alarm, Early};
use crate::{EarlyWake, Expiry, Timer, TimerError, Wake};

/// A periodic timer on a timerfd. The kernel counts the expirations, and a
/// read of the descriptor gives the count since the read before: all but one
/// of them are missed deadlines.
#[derive(Debug)]
pub struct TimerFd {
    period: Period,
    file: File,
    deadlines: Option<Deadlines>,
    early: Option<Early>,
}

impl TimerFd {
    pub(crate) const NAME: &str = "timerfd";

    /// Makes a timer, not yet started.
    ///
    /// # Errors
    /// When the period is not between 10 µs and 1 hour, or the operating
    /// system refuses.
    pub fn new(period: Duration) -> Result<Self, TimerError> {
        let period = Period::new(period)?;
        let descriptor = Descriptor::new(ClockId::CLOCK_MONOTONIC, TimerFlags::TFD_CLOEXEC)
            .map_err(os_error("timerfd_create"))?;
        Ok(Self {
            period,
            file: File { descriptor, period },
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

impl Timer for TimerFd {
    fn start(&mut self) -> Result<(), TimerError> {
        let deadlines = Early::grid(self.early.as_mut(), self.period);
        self.file.move_to(deadlines.alarm_ns())?;
        self.deadlines = Some(deadlines);
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        let deadlines = self.deadlines.as_mut().ok_or(TimerError::NotStarted)?;
        if let Some(early) = &mut self.early {
            return early.wait(deadlines, &mut self.file);
        }
        let passed = self.file.expirations()?;
        Ok(deadlines.woken(passed, monotonic_ns()))
    }

    fn wait_or_warm_up(&mut self) -> Result<Wake, TimerError> {
        match (&mut self.early, &mut self.deadlines) {
            (Some(early), Some(deadlines)) => early.wait_or_warm_up(deadlines, &mut self.file),
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

/// The kernel's timer.
#[derive(Debug)]
struct File {
    descriptor: Descriptor,
    period: Period,
}

impl File {
    /// Waits for an expiration; how many there were since the last call.
    fn expirations(&self) -> Result<u64, TimerError> {
        let mut count = [0; size_of::<u64>()];
        loop {
            match read(&self.descriptor, &mut count) {
                Ok(_) => return Ok(u64::from_ne_bytes(count)),
                Err(Errno::EINTR) => {}
                Err(errno) => return Err(os_error("read of a timerfd")(errno)),
            }
        }
    }
}

impl Alarm for File {
    fn move_to(&mut self, alarm_ns: i64) -> Result<(), TimerError> {
        self.descriptor
            .set(
                Expiration::IntervalDelayed(timespec(alarm_ns), timespec(self.period.ns())),
                TimerSetTimeFlags::TFD_TIMER_ABSTIME,
            )
            .map_err(os_error("timerfd_settime"))
    }

    fn sleep_until(&mut self, _: i64) -> Result<(), TimerError> {
        self.expirations().map(drop)
    }
}
