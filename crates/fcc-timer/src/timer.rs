//! What every periodic timer guarantees.

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
    /// Starts the grid of deadlines: now, or for a timer that wakes early up to
    /// 10 ms later, so that no kernel tick falls between wake-up and deadline.
    /// Call it on the thread that will wait; another call starts a new grid,
    /// numbered from 1.
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
    /// time left may return once before the deadline, with [`Wake::WarmUp`]:
    /// run what loads the caches for the tick and has no effect, then call
    /// this again.
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

    /// How much of the processor the next waits leave to other threads; without
    /// effect on a timer that has none to leave. Allocates nothing.
    ///
    /// # Errors
    /// When the operating system refuses.
    fn relieve(&mut self, _: Relief) -> Result<(), TimerError> {
        Ok(())
    }

    /// The time between deadlines.
    fn period(&self) -> Duration;

    /// Now, in nanoseconds on the same clock as the deadlines.
    fn now_ns(&self) -> i64;

    /// Its name in configuration and reports: `timerfd`, `posix`, ...
    fn name(&self) -> &'static str;
}

/// What a timer does so that a thread whose ticks take too long leaves time to
/// others.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Relief {
    /// Nothing: each deadline is served, late if it has passed.
    #[default]
    None,
    /// It does not wake early: the time of the spin is slept.
    NoSpin,
    /// It also skips deadlines: those that have passed, and those before which
    /// the thread would sleep for less than a nineteenth of the time that it was
    /// awake. So at least 5 % of the time is left to others, as Linux itself
    /// leaves by default (`sched_rt_runtime_us`, sched(7)). Skipped deadlines
    /// count as missed, and the phase is kept.
    Skip,
}

/// The result of a wait.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Wake {
    /// The deadline is near. The expiry is the one expected: its wake-up time is
    /// that of now, and a later deadline is served if the thread is delayed.
    WarmUp(Expiry),
    /// The deadline is reached.
    Deadline(Expiry),
}

/// One deadline that was served.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Expiry {
    /// Which deadline of the grid, the first being 1.
    pub number: u64,
    /// When it was due, ns on the timer's clock.
    pub scheduled_ns: i64,
    /// When the waiting thread continued, ns on the timer's clock: after the
    /// kernel woke it and, with early wake, after the deadline was reached.
    pub woke_ns: i64,
    /// Deadlines that passed unserved since the previous one served.
    pub missed: u64,
    /// How long before the deadline the kernel was asked to wake the thread,
    /// ns; 0 for a timer that does not wake early ([`crate::EarlyWake`]).
    pub early_wake_ns: u64,
    /// How long the thread then warmed up and spun until the deadline, ns.
    pub spun_ns: u64,
    /// How late the kernel woke the thread, ns after the requested time: the
    /// lateness without early wake. If the thread did not sleep, its lateness
    /// after the deadline.
    pub kernel_lateness_ns: i64,
    /// How much time since the deadline served before the thread had used when it
    /// began to wait, ns. If it is a period or more, the next deadline had passed.
    pub used_ns: u64,
}

impl Expiry {
    /// How late the thread woke, ns after the deadline. The period is something
    /// else: the time since the previous wake-up.
    #[must_use]
    pub const fn lateness_ns(&self) -> i64 {
        self.woke_ns.saturating_sub(self.scheduled_ns)
    }
}

/// Why a timer could not be created, started or waited for.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum TimerError {
    /// The operating system refused a call.
    #[error("{call} failed: {source}")]
    Os {
        /// The call that failed.
        call: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
    /// The period is outside what a timer can serve.
    #[error("a period of {} s cannot be timed: choose one between 10 µs and 1 hour", .0.as_secs_f64())]
    Period(Duration),
    /// An early-wake value that is out of its range.
    #[error("early wake: {0}")]
    EarlyWake(&'static str),
    /// `wait` was called before `start`.
    #[error("the timer was not started: call start() on the thread that will wait")]
    NotStarted,
    /// No deadline is left: the timer of a run of known length has ended.
    #[error("the timer has no deadline left")]
    Ended,
    /// `wait` was called on another thread than `start`; expiries are delivered
    /// to that thread only.
    #[error("the timer was started on another thread: call start() on the thread that waits")]
    WrongThread,
    /// Every real-time signal is used by a timer already.
    #[error("all real-time signals are taken: use fewer POSIX timers at a time, or a timerfd")]
    NoSignal,
}
