//! A timer that sends signals: `timer_create(2)`.
//!
//! The thesis took such a signal in a handler, where hardly anything may be
//! done. Here no handler runs: the signal is a real-time one, goes to the
//! loop's own thread, is blocked there, and `sigwaitinfo` takes it off the
//! queue like a message.

mod interval;
mod signal;

use std::thread::{self, ThreadId};
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns};
use crate::{Expiry, Timer, TimerError};
use interval::IntervalTimer;
use signal::TimerSignal;

/// A periodic timer on `timer_create`, with a real-time signal to the thread
/// that started it. The kernel keeps one signal queued and counts the
/// expiries that found it still there: those are the missed deadlines.
///
/// Each running timer has a real-time signal of its own, the highest that is
/// free.
#[derive(Debug)]
pub struct PosixTimer {
    period: Period,
    running: Option<Running>,
}

#[derive(Debug)]
struct Running {
    deadlines: Deadlines,
    thread: ThreadId,
    // Before the signal, because fields are dropped in this order: a signal is
    // let through again only when no timer can send it any more.
    timer: IntervalTimer,
    signal: TimerSignal,
}

impl PosixTimer {
    pub(crate) const NAME: &str = "posix";

    /// Makes a timer, not yet started.
    ///
    /// # Errors
    /// When the period is not between 10 µs and 1 hour.
    pub fn new(period: Duration) -> Result<Self, TimerError> {
        Ok(Self {
            period: Period::new(period)?,
            running: None,
        })
    }
}

impl Timer for PosixTimer {
    fn start(&mut self) -> Result<(), TimerError> {
        // The timer of a start before goes first, and its signal with it.
        self.running = None;
        let signal = TimerSignal::block()?;
        let mut timer = IntervalTimer::new(&signal)?;
        let deadlines = Deadlines::new(monotonic_ns(), self.period);
        timer.set(deadlines.alarm_ns(), self.period.ns())?;
        self.running = Some(Running {
            deadlines,
            thread: thread::current().id(),
            timer,
            signal,
        });
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        let running = self.running.as_mut().ok_or(TimerError::NotStarted)?;
        if running.thread != thread::current().id() {
            return Err(TimerError::WrongThread);
        }
        running.signal.wait()?;
        let woke_ns = monotonic_ns();
        let passed = running.timer.overruns()?.saturating_add(1);
        Ok(running.deadlines.woken(passed, woke_ns))
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
