//! What every periodic timer promises.

use std::time::Duration;

/// A periodic timer: deadlines at `start + n * period`, for n = 1, 2, 3, ...
///
/// The phase never moves. A wait that begins after deadlines have passed
/// returns at once and serves the latest of them, late; the ones before it are
/// counted in [`Expiry::missed`]. The wait after that ends at the next deadline
/// of the same grid. So a tick of 1.1 periods makes the next one late and
/// nothing missed, and a tick of 3.5 periods makes the next one late and two
/// missed.
pub trait Timer: Send {
    /// Sets the grid of deadlines going: from now, or where a timer wakes early
    /// up to 10 ms later, so that the kernel's ticks fall beside its deadlines. To be called on the thread
    /// that will wait; calling it again begins a new grid, with numbers from 1.
    ///
    /// # Errors
    /// When the operating system refuses.
    fn start(&mut self) -> Result<(), TimerError>;

    /// Waits for the next deadline, and never returns before it. Allocates
    /// nothing.
    ///
    /// # Errors
    /// When the timer was not started, or when the operating system refuses;
    /// never for a signal that interrupts.
    fn wait(&mut self) -> Result<Expiry, TimerError>;

    /// Waits like [`wait`](Self::wait), but a timer that wakes early and has
    /// time left may come back once before the deadline, with
    /// [`Wake::WarmUp`]: do what warms the caches for the tick and changes
    /// nothing, and call again.
    ///
    /// # Errors
    /// Those of `wait`.
    fn wait_or_warm_up(&mut self) -> Result<Wake, TimerError> {
        self.wait().map(Wake::Deadline)
    }

    /// Makes a timer that wakes early wake at its deadlines, from the next
    /// [`start`](Self::start) on. For a thread that has no real-time priority:
    /// others interrupt its spin, so it costs CPU time and gains nothing.
    fn disable_early_wake(&mut self) {}

    /// The time between deadlines.
    fn period(&self) -> Duration;

    /// Now, in nanoseconds on the same clock as the deadlines.
    fn now_ns(&self) -> i64;

    /// What people and configuration call it: `timerfd`, `posix`, ...
    fn name(&self) -> &'static str;
}

/// What a wait ended with.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Wake {
    /// The deadline is near. What it will be, but for the time of waking, and
    /// unless the machine is elsewhere meanwhile.
    WarmUp(Expiry),
    /// The deadline has come.
    Deadline(Expiry),
}

/// One deadline that was served.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Expiry {
    /// Which deadline of the grid, the first being 1.
    pub number: u64,
    /// When it was due, ns on the timer's clock.
    pub scheduled_ns: i64,
    /// When the waiting thread went on, ns on the timer's clock: after the
    /// kernel woke it and, where it was woken early, the deadline had come.
    pub woke_ns: i64,
    /// Deadlines passed unserved since the one served before.
    pub missed: u64,
    /// How long before the deadline the kernel was asked to wake the thread,
    /// ns; 0 for a timer that does not wake early ([`crate::EarlyWake`]).
    pub early_wake_ns: u64,
    /// How long the thread then rehearsed and spun towards the deadline, ns.
    pub spun_ns: u64,
    /// How late the kernel woke the thread, ns after the time it was asked to:
    /// the lateness that there would be without waking early. Where the thread
    /// did not sleep, the lateness that there is.
    pub kernel_lateness_ns: i64,
}

impl Expiry {
    /// How late the thread woke, ns after the deadline. Not to be mixed up
    /// with the period, which is the time since it woke before.
    #[must_use]
    pub const fn lateness_ns(&self) -> i64 {
        self.woke_ns.saturating_sub(self.scheduled_ns)
    }
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
    /// The period is outside what a timer can serve.
    #[error("a period of {0:?} cannot be timed: choose one between 10 µs and 1 hour")]
    Period(Duration),
    /// An early wake with a value that makes no sense.
    #[error("early wake: {0}")]
    EarlyWake(&'static str),
    /// `wait` before `start`.
    #[error("the timer was not started: call start() on the thread that will wait")]
    NotStarted,
    /// No deadline is left: the timer of a run of known length is over.
    #[error("the timer has no deadline left")]
    Ended,
    /// `wait` on another thread than `start`, where the expiries do not come.
    #[error("the timer was started on another thread: call start() on the thread that waits")]
    WrongThread,
    /// Every real-time signal already belongs to a timer.
    #[error("all real-time signals are taken: use fewer POSIX timers at a time, or a timerfd")]
    NoSignal,
}
