//! Datagrams that a newer one overtook, and a clock that was set back.

use core::time::Duration;

use fcc_core::framework::Time;

use super::ClockSample;

/// Two datagrams of one flight are mostly less than this apart when one overtakes
/// the other; time that goes back further and continues there was set back.
const LATE_S: f64 = 1.0;
/// For this long, from the first one on, older times may belong to late datagrams,
/// also after a silence: those may arrive first that were sent before it. A newer
/// one follows within the network's jitter; without one, another flight runs.
pub(super) const LATE: Duration = Duration::from_millis(400);

/// Tells older times of late datagrams from those of a clock that was set back.
/// It starts anew with each newer time.
#[derive(Clone, Copy, Debug)]
pub(super) struct LateFilter {
    /// When the first of the older times arrived that were taken for late ones
    /// since the latest; never if there was none.
    since: Time,
    /// A time that is earlier by [`LATE_S`] or more, until a newer one arrives.
    set_back: Option<ClockSample>,
}

impl Default for LateFilter {
    fn default() -> Self {
        Self {
            since: Time::NEVER,
            set_back: None,
        }
    }
}

impl LateFilter {
    /// Whether a time was overtaken by the latest; not if they are equal.
    pub(super) fn is_late(&mut self, sample: ClockSample, latest: ClockSample) -> bool {
        let back_s = latest.time_s - sample.time_s;
        if back_s <= 0.0 {
            return false;
        }
        if back_s >= LATE_S {
            return !self.is_set_back(sample);
        }
        if self.since.is_never() {
            self.since = sample.seen;
        }
        sample.seen.since(self.since) < LATE
    }

    /// Whether a much earlier time continues one of an earlier tick.
    fn is_set_back(&mut self, sample: ClockSample) -> bool {
        let follows = |at: &ClockSample| sample.time_s >= at.time_s && !sample.is_ahead_of(*at);
        let first = self.set_back.filter(follows);
        self.set_back = first.or(Some(sample));
        first.is_some_and(|first| sample.seen > first.seen)
    }
}
