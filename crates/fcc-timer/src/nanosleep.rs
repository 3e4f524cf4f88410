//! A timer that sleeps: `clock_nanosleep(2)` to absolute deadlines.

use nix::errno::Errno;
use nix::time::{ClockId, ClockNanosleepFlags, clock_nanosleep};
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns, os_error, timespec};
use crate::early::{Alarm, Early};
use crate::periodic::{self, Kernel, periodic};
use crate::{EarlyWake, Expiry, Relief, Timer, TimerError, Wake};

periodic! {
    /// A periodic timer made of sleeps. Nothing runs in the kernel between two
    /// waits. It is the only timer here that the timer slack delays if the thread
    /// is not real-time.
    Nanosleep, "nanosleep", Sleep
}

/// A sleep has no kernel timer to set.
#[derive(Debug)]
struct Sleep;

impl Kernel for Sleep {
    fn new(_: Period) -> Result<Self, TimerError> {
        Ok(Self)
    }
}

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
