//! Datagrams that a newer one overtook, and a clock that was set.

use core::time::Duration;

use fcc_core::framework::Time;

use super::ClockSample;

/// Two datagrams of one flight are mostly less than this apart when one overtakes
/// the other; time that goes back further and continues there was set back.
pub(super) const LATE_S: f64 = 1.0;
/// For this long, from the first one on, older times may belong to late datagrams,
/// also after a silence: those may arrive first that were sent before it. A newer
/// one follows within the network's jitter; without one, another flight runs.
pub(super) const LATE: Duration = Duration::from_millis(400);

/// A network that held some back for seconds may deliver them beside what is new, and
/// that comes in each of 20 frames a second: for so long, [`LATE_S`] and more is late
/// then, too.
pub(super) const BESIDE: Duration = Duration::from_millis(150);

/// Tells older times of late datagrams from those of a clock that was set back.
/// It starts anew with each newer time.
#[derive(Clone, Copy, Debug)]
pub(super) struct LateFilter {
    /// When the first of the older times arrived that were taken for late ones
    /// since the latest; never if there was none.
    since: Time,
    /// Of a time that is earlier by [`LATE_S`] or more.
    set_back: Claim,
}

/// A time that is far from the latest one. It is believed with a second
/// datagram, in a later tick, that continues it: one alone was overtaken, or is
/// not the simulator's. To be forgotten when another time is believed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Claim(Option<ClockSample>);

impl Claim {
    /// Whether such a time continues one of an earlier tick.
    pub(super) fn is_continued_by(&mut self, sample: ClockSample) -> bool {
        let follows = |at: &ClockSample| sample.time_s >= at.time_s && !sample.is_ahead_of(*at);
        let first = self.0.filter(follows);
        self.0 = first.or(Some(sample));
        first.is_some_and(|first| sample.seen > first.seen)
    }
}

impl Default for LateFilter {
    fn default() -> Self {
        Self {
            since: Time::NEVER,
            set_back: Claim::default(),
        }
    }
}

impl LateFilter {
    /// Whether a time was overtaken by the latest; not if they are equal. `held_back`:
    /// a newer one arrived after a gap, not long ago.
    pub(super) fn is_late(
        &mut self,
        sample: ClockSample,
        latest: ClockSample,
        held_back: bool,
    ) -> bool {
        let back_s = latest.time_s - sample.time_s;
        if back_s <= 0.0 {
            return false;
        }
        if self.since.is_never() {
            self.since = sample.seen;
        }
        let passed = sample.seen.since(self.since);
        if back_s >= LATE_S {
            !self.set_back.is_continued_by(sample) || held_back && passed < BESIDE
        } else {
            passed < LATE
        }
    }
}
