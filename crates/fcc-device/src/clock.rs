//! The loop's clock.

use core::fmt;
use std::sync::Arc;

use fcc_core::framework::Time;
use nix::sys::time::TimeValLike;
use nix::time::{ClockId, clock_gettime};

/// Now on the loop's clock, `CLOCK_MONOTONIC`. Not for a tick, which has its own
/// time: for the threads that read devices.
pub fn monotonic() -> Time {
    clock_gettime(ClockId::CLOCK_MONOTONIC)
        .map_or(Time::NEVER, |now| Time::from_nanos(now.num_nanoseconds()))
}

/// The clock that samples are stamped with: the loop's by default, and another
/// one in a test, where time is computed.
///
/// ```
/// use fcc_core::framework::Time;
/// use fcc_device::Clock;
///
/// let stopped = Clock::new(|| Time::from_nanos(5));
/// assert_eq!(stopped.now(), Time::from_nanos(5));
/// assert!(Clock::default().now() <= Clock::default().now());
/// ```
#[derive(Clone)]
pub struct Clock(Arc<dyn Fn() -> Time + Send + Sync>);

impl Clock {
    /// A clock with the time that a function gives.
    pub fn new(now: impl Fn() -> Time + Send + Sync + 'static) -> Self {
        Self(Arc::new(now))
    }

    /// The time.
    pub fn now(&self) -> Time {
        (self.0)()
    }
}

impl Default for Clock {
    /// [`monotonic`].
    fn default() -> Self {
        Self::new(monotonic)
    }
}

impl fmt::Debug for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Clock")
    }
}
