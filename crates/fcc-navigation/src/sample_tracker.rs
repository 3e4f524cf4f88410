//! Which readings are current, and which are new.

use core::time::Duration;

use fcc_core::framework::{Reading, Time};

/// A source that is silent for longer than this is no longer integrated, and
/// when it returns, its value is adopted at once.
const CURRENT: Duration = Duration::from_millis(500);

/// Whether a reading was taken within the last half second.
pub fn is_current<T>(reading: &Reading<T>, now: Time) -> bool {
    reading.is_fresh(now, CURRENT)
}

/// Distinguishes new values from ones processed before, and determines how to
/// use them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SampleTracker {
    taken: Time,
    /// The next new one is adopted at once, whatever its age.
    pub(super) adopts_next: bool,
}

/// How to use a measurement.
pub(super) enum NewSample {
    /// Nothing new.
    None,
    /// The first, or the first after a long silence: adopt it at once.
    First,
    /// A further one, this many seconds after the previous one.
    Next(f64),
}

impl SampleTracker {
    pub(super) const fn new() -> Self {
        Self {
            taken: Time::NEVER,
            adopts_next: false,
        }
    }

    pub(super) fn postpone(&mut self, by: Duration, latest: Time) {
        self.taken = self.taken.postponed(by, latest);
    }

    /// `dt_s` is the plant's time since the last tick: while it does not
    /// advance, a measurement is not new.
    pub(super) fn of<T>(&mut self, reading: &Reading<T>, dt_s: f64) -> NewSample {
        if reading.is_never() || reading.taken <= self.taken {
            return NewSample::None;
        }
        let gap = reading.taken.since(self.taken);
        self.taken = reading.taken;
        if core::mem::take(&mut self.adopts_next) || gap > CURRENT {
            NewSample::First
        } else if dt_s > 0.0 {
            NewSample::Next(gap.as_secs_f64())
        } else {
            NewSample::None
        }
    }
}
