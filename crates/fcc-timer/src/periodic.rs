//! What the timers of the kernel have in common: all but the calls.

use crate::deadlines::{Deadlines, Period, monotonic_ns};
use crate::early::Alarm;
use crate::{Expiry, Relief, TimerError};

/// One of the kernel's ways to wake a thread periodically.
pub(crate) trait Kernel: Alarm + Sized {
    /// Makes what is needed, without an alarm.
    fn new(period: Period) -> Result<Self, TimerError>;

    /// Whether the calling thread is the one that is woken.
    fn check_thread(&self) -> Result<(), TimerError> {
        Ok(())
    }
}

/// Waits for a deadline and serves it, without early wake. An alarm may be one
/// of a deadline that has been served or skipped, so the clock decides.
pub(crate) fn wait(
    deadlines: &mut Deadlines,
    kernel: &mut impl Alarm,
    relief: Relief,
) -> Result<Expiry, TimerError> {
    let mut now_ns = monotonic_ns();
    let used_ns = deadlines.used_ns(now_ns);
    let due_ns = deadlines.awaited_ns(now_ns, relief);
    while now_ns < due_ns {
        kernel.sleep_until(due_ns)?;
        now_ns = monotonic_ns();
    }
    Ok(Expiry {
        used_ns,
        ..deadlines.woken(now_ns)
    })
}

/// Declares a timer, its name, and the [`Kernel`] that it waits by.
macro_rules! periodic {
    ($(#[$doc:meta])* $timer:ident, $name:literal, $kernel:ty) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $timer {
            period: Period,
            running: Option<(Deadlines, $kernel)>,
            early: Option<Early>,
            relief: Relief,
        }

        impl $timer {
            pub(crate) const NAME: &str = $name;

            /// Makes a timer, not yet started.
            ///
            /// # Errors
            /// When the period is not between 10 µs and 1 hour.
            pub fn new(period: Duration) -> Result<Self, TimerError> {
                Ok(Self {
                    period: Period::new(period)?,
                    running: None,
                    early: None,
                    relief: Relief::None,
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

        impl Timer for $timer {
            fn start(&mut self) -> Result<(), TimerError> {
                // What an earlier start made is given back first.
                self.running = None;
                self.relief = Relief::None;
                let mut kernel = <$kernel>::new(self.period)?;
                let deadlines = Early::grid(self.early.as_mut(), self.period);
                kernel.move_to(deadlines.alarm_ns())?;
                self.running = Some((deadlines, kernel));
                Ok(())
            }

            fn wait(&mut self) -> Result<Expiry, TimerError> {
                let (deadlines, kernel) = self.running.as_mut().ok_or(TimerError::NotStarted)?;
                kernel.check_thread()?;
                match &mut self.early {
                    Some(early) if self.relief == Relief::None => early.wait(deadlines, kernel),
                    _ => periodic::wait(deadlines, kernel, self.relief),
                }
            }

            fn wait_or_warm_up(&mut self) -> Result<Wake, TimerError> {
                match (&mut self.early, &mut self.running) {
                    (Some(early), Some((deadlines, kernel))) if self.relief == Relief::None => {
                        kernel.check_thread()?;
                        early.wait_or_warm_up(deadlines, kernel)
                    }
                    _ => self.wait().map(Wake::Deadline),
                }
            }

            fn disable_early_wake(&mut self) {
                self.early = None;
            }

            fn relieve(&mut self, relief: Relief) -> Result<(), TimerError> {
                let before = std::mem::replace(&mut self.relief, relief);
                let spins = relief == Relief::None;
                if let (Some(early), Some((deadlines, kernel))) = (&mut self.early, &mut self.running)
                    && spins != (before == Relief::None)
                {
                    deadlines.wake_early(if spins { early.interrupted() } else { 0 });
                    kernel.move_to(deadlines.alarm_ns())?;
                }
                Ok(())
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
    };
}
pub(crate) use periodic;
