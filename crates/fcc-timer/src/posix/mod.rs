//! A timer that sends signals: `timer_create(2)`.
//!
//! The thesis handled such a signal in a signal handler, in which few functions
//! may be called. Here there is no handler: the real-time signal is sent to the
//! loop's own thread, blocked there, and received with `sigtimedwait`.

mod interval;
mod signal;

use std::thread::{self, ThreadId};
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns};
use crate::early::{Alarm, Early};
use crate::periodic::{self, Kernel, periodic};
use crate::{EarlyWake, Expiry, Relief, Timer, TimerError, Wake};
use interval::IntervalTimer;
use signal::TimerSignal;

periodic! {
    /// A periodic timer on `timer_create`, with a real-time signal to the thread
    /// that started it, which waits for it.
    ///
    /// Each running timer has a real-time signal of its own, the highest that is
    /// free.
    PosixTimer, "posix", Signals
}

/// The kernel's timer and the signal that it sends.
#[derive(Debug)]
struct Signals {
    period: Period,
    /// The one that the signals are sent to.
    thread: ThreadId,
    // Before the signal, because fields are dropped in this order: a signal is
    // let through again only when no timer can send it any more.
    timer: IntervalTimer,
    signal: TimerSignal,
}

impl Kernel for Signals {
    fn new(period: Period) -> Result<Self, TimerError> {
        let signal = TimerSignal::block()?;
        let timer = IntervalTimer::new(&signal)?;
        Ok(Self {
            period,
            thread: thread::current().id(),
            timer,
            signal,
        })
    }

    fn check_thread(&self) -> Result<(), TimerError> {
        if self.thread == thread::current().id() {
            Ok(())
        } else {
            Err(TimerError::WrongThread)
        }
    }
}

impl Alarm for Signals {
    fn move_to(&mut self, alarm_ns: i64) -> Result<(), TimerError> {
        self.timer.set(alarm_ns, self.period.ns())
    }

    fn sleep_until(&mut self, _: i64) -> Result<(), TimerError> {
        self.signal.wait()
    }
}
