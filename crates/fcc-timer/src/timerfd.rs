//! A timer that is read like a file: `timerfd_create(2)`.

use nix::errno::Errno;
use nix::sys::timerfd::{
    ClockId, Expiration, TimerFd as Descriptor, TimerFlags, TimerSetTimeFlags,
};
use nix::unistd::read;
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns, os_error, timespec};
use crate::early::{Alarm, Early};
use crate::periodic::{self, Kernel, periodic};
use crate::{EarlyWake, Expiry, Relief, Timer, TimerError, Wake};

periodic! {
    /// A periodic timer on a timerfd: a read of its descriptor waits for the next
    /// expiration.
    TimerFd, "timerfd", File
}

/// The kernel's timer.
#[derive(Debug)]
struct File {
    descriptor: Descriptor,
    period: Period,
}

impl Kernel for File {
    fn new(period: Period) -> Result<Self, TimerError> {
        let descriptor = Descriptor::new(ClockId::CLOCK_MONOTONIC, TimerFlags::TFD_CLOEXEC)
            .map_err(os_error("timerfd_create"))?;
        Ok(Self { descriptor, period })
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
        let mut count = [0; size_of::<u64>()];
        loop {
            match read(&self.descriptor, &mut count) {
                Ok(_) => return Ok(()),
                Err(Errno::EINTR) => {}
                Err(errno) => return Err(os_error("read of a timerfd")(errno)),
            }
        }
    }
}
