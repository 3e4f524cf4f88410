//! How long it takes from writing a value to reading it back.

use core::time::Duration;

use fcc_core::framework::Time;

/// Over such a time it is the longest that was seen: the same value may be written again
/// and again.
const OVER: Duration = Duration::from_secs(1);

/// The round trip of the last second that has passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundTrip {
    since: Time,
    longest: Duration,
    shown: Duration,
}

impl RoundTrip {
    pub(crate) const fn begin(now: Time) -> Self {
        Self {
            since: now,
            longest: Duration::ZERO,
            shown: Duration::ZERO,
        }
    }

    pub(crate) fn add(&mut self, now: Time, took: Duration) {
        if now.since(self.since) >= OVER {
            (self.since, self.shown) = (now, self.longest);
            self.longest = Duration::ZERO;
        }
        self.longest = self.longest.max(took);
    }

    pub(crate) const fn shown(&self) -> Duration {
        self.shown
    }
}
