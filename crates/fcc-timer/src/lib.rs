//! The clock of the loop.
//!
//! Three periodic timers behind one trait, [`Timer`]: [`TimerFd`],
//! [`PosixTimer`] and [`Nanosleep`], all on `CLOCK_MONOTONIC` with absolute
//! deadlines, so that a late tick delays no other and the phase is kept. A fourth,
//! [`ManualTimer`], never waits: it drives a loop in lockstep with a simulator
//! or a test. The first three reach a lateness below the kernel's own tens of
//! microseconds by waking early and spinning until the deadline: [`EarlyWake`].
//!
//! Also what a real-time thread needs of the kernel: [`realtime`] requests
//! scheduling, a CPU and locked memory and reads back what was granted,
//! [`TimingStats`] records periods and lateness in fixed memory, and the
//! functions of [`usage`] return the thread's CPU time and page faults.
//!
//! ```
//! use fcc_timer::{TimerKind, TimingStats};
//! use std::time::Duration;
//!
//! let period = Duration::from_millis(2);
//! let mut timer = TimerKind::Timerfd.build(period)?;
//! let mut stats = TimingStats::new(period)?;
//! timer.start()?;
//! for _ in 0..5 {
//!     let expiry = timer.wait()?;
//!     stats.record(&expiry);
//! }
//! assert_eq!(stats.summary().ticks, 5);
//! # Ok::<(), fcc_timer::TimerError>(())
//! ```

mod deadlines;
mod early;
mod kind;
mod manual;
mod nanosleep;
mod periodic;
mod posix;
pub mod realtime;
mod started;
mod stats;
mod timer;
mod timerfd;
pub mod usage;

pub use early::EarlyWake;
pub use kind::{TimerKind, UnknownTimer};
pub use manual::ManualTimer;
pub use nanosleep::Nanosleep;
pub use posix::PosixTimer;
pub use realtime::{
    CpuRequest, DeniedRequest, RealtimeDenied, RealtimeGranted, RealtimeRequest, Strictness,
};
pub use started::not_started;
pub use stats::{TimingStats, TimingSummary};
pub use timer::{Expiry, Relief, Timer, TimerError, Wake};
pub use timerfd::TimerFd;
