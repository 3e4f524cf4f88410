//! What every periodic timer promises.

use std::time::Duration;

/// A periodic timer: deadlines at `start + n * period`, for n = 1, 2, 3, ...
///
/// The phase never moves: a deadline that passed unserved is counted in
/// [`Expiry::missed`], and the next wait ends at the next deadline of the same
/// grid.
pub trait Timer: Send {
    /// Sets the grid of deadlines going, from now. To be called once, on the
    /// thread that will wait.
    ///
    /// # Errors
    /// When the operating system refuses.
    fn start(&mut self) -> Result<(), TimerError>;

    /// Waits for the next deadline. Allocates nothing.
    ///
    /// # Errors
    /// When the operating system refuses; never for a signal that interrupts.
    fn wait(&mut self) -> Result<Expiry, TimerError>;

    /// The time between deadlines.
    fn period(&self) -> Duration;

    /// Now, in nanoseconds on the same clock as the deadlines.
    fn now_ns(&self) -> i64;

    /// What people and configuration call it: `timerfd`, `posix`, ...
    fn name(&self) -> &'static str;
}

/// One deadline that was served.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Expiry {
    /// Which deadline of the grid, the first being 1.
    pub number: u64,
    /// When it was due, ns on the timer's clock.
    pub scheduled_ns: i64,
    /// When the waiting thread woke, ns on the timer's clock.
    pub woke_ns: i64,
    /// Deadlines passed unserved since the one served before.
    pub missed: u64,
}

/// Why a timer could not be made, started or waited for.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum TimerError {
    /// The operating system refused a call.
    #[error("{call} failed: {source}")]
    Os {
        /// The call that failed.
        call: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// The period is zero, or longer than the clock can count.
    #[error("a period of {0:?} cannot be timed: choose one between 10 µs and 1 hour")]
    Period(Duration),
    /// `wait` before `start`.
    #[error("the timer was not started")]
    NotStarted,
}
