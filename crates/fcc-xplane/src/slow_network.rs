//! When it is said that what is written takes effect too late.

use std::time::{Duration, Instant};

/// The loops are tuned for a latency of 0.12 s. Above this round trip, s, for so long,
/// a flight is not what it should be; a simulator that stops for a moment is over
/// sooner.
pub(crate) const SLOW_S: f32 = 0.25;
const SLOW_FOR: Duration = Duration::from_secs(3);

/// Follows the round trip.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlowNetwork {
    since: Option<Instant>,
    is_said: bool,
}

impl SlowNetwork {
    /// Whether it is to be said, once.
    pub(crate) fn step(&mut self, now: Instant, round_trip_s: f32) -> bool {
        if round_trip_s <= SLOW_S {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(now);
        let says = !self.is_said && now.duration_since(since) >= SLOW_FOR;
        self.is_said |= says;
        says
    }
}
