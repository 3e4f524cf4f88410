//! The clock of the loop.
//!
//! Three periodic timers behind one trait, [`Timer`]: timerfd, POSIX timer and
//! `clock_nanosleep`, all on `CLOCK_MONOTONIC` with absolute deadlines, so
//! that a late tick is late once and the phase is kept.

mod timer;

pub use timer::{Expiry, Timer, TimerError};
