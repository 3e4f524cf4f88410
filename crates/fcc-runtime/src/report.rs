//! The report of a loop that has ended.

use std::fmt;
use std::time::Duration;

use fcc_core::framework::Cause;
use fcc_timer::{RealtimeGranted, TimerError, TimingSummary};

/// The report of a loop that has ended.
#[derive(Debug)]
pub struct LoopReport {
    /// Why it ended.
    pub ending: Ending,
    /// Ticks performed.
    pub ticks: u64,
    /// The timer's name: `timerfd`, `posix`, ...
    pub timer: &'static str,
    /// Timing statistics, including missed ticks.
    pub timing: TimingSummary,
    /// How often it entered failsafe.
    pub failsafes: u64,
    /// The cause of the last time.
    pub last_failsafe: Option<Cause>,
    /// Whether every actuator gave control back. If not, control may still be
    /// held.
    pub released: bool,
    /// Failed samples of sensors.
    pub sensor_faults: u64,
    /// Failed writes and releases of actuators.
    pub actuator_faults: u64,
    /// Ticks that overran their budget.
    pub overruns: u64,
    /// Ticks that left no time to sleep before the next.
    pub unslept: u64,
    /// Records lost because they were not read in time.
    pub records_dropped: u64,
    /// Events lost because they were not read in time.
    pub events_dropped: u64,
    /// CPU time that the loop's thread spent from the timer's start on.
    pub cpu_time: Duration,
    /// Page faults of the loop's thread from the timer's start on; none where
    /// they were not counted.
    pub page_faults: Option<u64>,
    /// What the kernel granted the loop's thread; `None` without a thread of its
    /// own.
    pub granted: Option<RealtimeGranted>,
}

/// Why a loop ended.
#[derive(Debug)]
#[non_exhaustive]
pub enum Ending {
    /// [`LoopCommand::Stop`](crate::LoopCommand::Stop) came.
    StopCommand,
    /// The stop flag was set: [`StopHandle`](crate::StopHandle).
    StopFlag,
    /// The engage switch went off, and that is configured to end the loop.
    SwitchedOff,
    /// Failsafe was over, and that is configured to end the loop.
    FailsafeEnded,
    /// Control had to be given back at once, and that is configured to end the
    /// loop, as a failsafe is.
    ReleasedAtOnce,
    /// For too long no tick left time to sleep: [`Overload`](crate::Overload).
    Overloaded,
    /// A part panicked, with this message.
    Panicked(String),
    /// The timer failed.
    TimerFailed(TimerError),
    /// The timer had no more deadlines.
    TimerEnded,
    /// It hung, and its watchdog ended it. The report is made by the caller, from
    /// the records received.
    Hung,
    /// The caller finished the [`Machine`](crate::Machine).
    Finished,
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StopCommand => f.write_str("stopped by command"),
            Self::StopFlag => f.write_str("stop requested"),
            Self::SwitchedOff => f.write_str("switched off"),
            Self::FailsafeEnded => f.write_str("failsafe ended"),
            Self::ReleasedAtOnce => f.write_str("control was given back at once"),
            Self::Overloaded => f.write_str("overloaded for too long"),
            Self::Panicked(message) => write!(f, "a part panicked: {message}"),
            Self::TimerFailed(error) => write!(f, "the timer failed: {error}"),
            Self::TimerEnded => f.write_str("the timer ended"),
            Self::Hung => f.write_str("the loop hung"),
            Self::Finished => f.write_str("finished"),
        }
    }
}
