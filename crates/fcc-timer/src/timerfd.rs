//! A timer that is read like a file: `timerfd_create(2)`.

use nix::errno::Errno;
use nix::sys::timerfd::{
    ClockId, Expiration, TimerFd as Descriptor, TimerFlags, TimerSetTimeFlags,
};
use nix::unistd::read;
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns, refused, timespec};
use crate::{Expiry, Timer, TimerError};

/// A periodic timer on a timerfd. The kernel counts the expirations, and a
/// read of the descriptor gives the count since the read before: all but one
/// of them are missed deadlines.
#[derive(Debug)]
pub struct TimerFd {
    period: Period,
    descriptor: Descriptor,
    deadlines: Option<Deadlines>,
}

impl TimerFd {
    pub(crate) const NAME: &str = "timerfd";

    /// Makes a timer, not yet started.
    ///
    /// # Errors
    /// When the period is not between 10 µs and 1 hour, or the operating
    /// system refuses.
    pub fn new(period: Duration) -> Result<Self, TimerError> {
        Ok(Self {
            period: Period::new(period)?,
            descriptor: Descriptor::new(ClockId::CLOCK_MONOTONIC, TimerFlags::TFD_CLOEXEC)
                .map_err(refused("timerfd_create"))?,
            deadlines: None,
        })
    }
}

impl Timer for TimerFd {
    fn start(&mut self) -> Result<(), TimerError> {
        let deadlines = Deadlines::new(monotonic_ns(), self.period);
        let first = timespec(deadlines.alarm_ns());
        self.descriptor
            .set(
                Expiration::IntervalDelayed(first, timespec(self.period.ns())),
                TimerSetTimeFlags::TFD_TIMER_ABSTIME,
            )
            .map_err(refused("timerfd_settime"))?;
        self.deadlines = Some(deadlines);
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        let deadlines = self.deadlines.as_mut().ok_or(TimerError::NotStarted)?;
        let mut count = [0; size_of::<u64>()];
        loop {
            match read(&self.descriptor, &mut count) {
                Ok(_) => {
                    let woke_ns = monotonic_ns();
                    return Ok(deadlines.woken(u64::from_ne_bytes(count), woke_ns));
                }
                Err(Errno::EINTR) => {}
                Err(errno) => return Err(refused("read of a timerfd")(errno)),
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
