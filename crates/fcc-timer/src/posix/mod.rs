//! A timer that sends signals: `timer_create(2)`.
//!
//! The thesis handled such a signal in a signal handler, in which few functions
//! may be called. Here there is no handler: the real-time signal is sent to the
//! loop's own thread, blocked there, and received with `sigwaitinfo`.

mod interval;
mod signal;

use std::thread::{self, ThreadId};
use std::time::Duration;

use crate::deadlines::{Deadlines, Period, monotonic_ns};
use crate::early::{Alarm, Early};
use crate::{EarlyWake, Expiry, Timer, TimerError, Wake};
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
    early: Option<Early>,
}

#[derive(Debug)]
struct Running {
    deadlines: Deadlines,
    thread: ThreadId,
    signals: Signals,
}

impl Running {
    /// The signals are sent to the thread that started the timer.
    fn check_thread(&self) -> Result<(), TimerError> {
        if self.thread == thread::current().id() {
            Ok(())
        } else {
            Err(TimerError::WrongThread)
        }
    }
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

impl Timer for PosixTimer {
    fn start(&mut self) -> Result<(), TimerError> {
        // The timer of an earlier start is deleted first, with its signal.
        self.running = None;
        let mut signals = Signals::new(self.period)?;
        let deadlines = Early::grid(self.early.as_mut(), self.period);
        signals.move_to(deadlines.alarm_ns())?;
        self.running = Some(Running {
            deadlines,
            thread: thread::current().id(),
            signals,
        });
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        let running = self.running.as_mut().ok_or(TimerError::NotStarted)?;
        running.check_thread()?;
        if let Some(early) = &mut self.early {
            return early.wait(&mut running.deadlines, &mut running.signals);
        }
        running.signals.signal.wait()?;
        let woke_ns = monotonic_ns();
        let passed = running.signals.timer.overruns()?.saturating_add(1);
        Ok(running.deadlines.woken(passed, woke_ns))
    }

    fn wait_or_warm_up(&mut self) -> Result<Wake, TimerError> {
        match (&mut self.early, &mut self.running) {
            (Some(early), Some(running)) => {
                running.check_thread()?;
                early.wait_or_warm_up(&mut running.deadlines, &mut running.signals)
            }
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

/// The kernel's timer and the signal that it sends.
#[derive(Debug)]
struct Signals {
    period: Period,
    // Before the signal, because fields are dropped in this order: a signal is
    // let through again only when no timer can send it any more.
    timer: IntervalTimer,
    signal: TimerSignal,
}

impl Signals {
    fn new(period: Period) -> Result<Self, TimerError> {
        let signal = TimerSignal::block()?;
        let timer = IntervalTimer::new(&signal)?;
        Ok(Self {
            period,
            timer,
            signal,
        })
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
