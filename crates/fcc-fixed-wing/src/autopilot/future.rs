//! Readings from the future.
//!
//! The time of a reading cannot be later than the tick that uses it. One that is
//! comes from a clock that was not mapped to the loop's, or is damaged: if it were
//! believed, every later reading of that sensor would count as older than it.

use core::time::Duration;

use fcc_core::flight::Measurements;
use fcc_core::framework::{Readings, Time};

/// A reading that is taken in the tick itself may be as much later than its
/// wake-up.
const WITHIN_THE_TICK: Duration = Duration::from_millis(5);

/// Whether any reading was taken later than now.
pub(super) fn is_from_the_future(measured: &Measurements, now: Time) -> bool {
    let latest = now + WITHIN_THE_TICK;
    let mut is_future = false;
    measured.each_source(&mut |_, taken| is_future |= taken > latest);
    is_future
}

/// The measurements without the readings that were taken later than now.
pub(super) fn without_future(mut measured: Measurements, now: Time) -> Measurements {
    let latest = now + WITHIN_THE_TICK;
    measured.each_time(&mut |taken| {
        if *taken > latest {
            *taken = Time::NEVER;
        }
    });
    measured
}
