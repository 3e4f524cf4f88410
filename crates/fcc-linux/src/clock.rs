//! The loop's clock.

use fcc_core::framework::Time;
use nix::time::{ClockId, clock_gettime};

/// Now on the loop's clock, `CLOCK_MONOTONIC`. Not for a tick, which has its own
/// time: for the threads that read devices.
pub fn monotonic() -> Time {
    clock_gettime(ClockId::CLOCK_MONOTONIC).map_or(Time::NEVER, |now| {
        Time::from_nanos(now.tv_sec() * 1_000_000_000 + now.tv_nsec())
    })
}
