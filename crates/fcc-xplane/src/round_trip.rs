//! How long it takes from writing a value to reading it back.

use core::time::Duration;

use fcc_core::framework::Time;

/// Over such a time it is the longest that was seen: the same value may be written again
/// and again.
const OVER: Duration = Duration::from_secs(1);
/// No aircraft is flown over a longer round trip, if it was longer in so many of those times
/// in succession.
const TOO_LONG: Duration = Duration::from_millis(500);
const TIMES: u8 = 2;

/// While it is too long the rudder is put aside by this much more in each such time, s, up to
/// so often: a value that does not change says nothing of when it was written.
const MARK: f64 = 2.5e-4;
const MARKED_FOR: Duration = Duration::from_millis(250);
const MARKS: u64 = 20;

/// By how much the rudder is put aside at a time, of its range 0..1.
pub(crate) fn mark(now: Time) -> f64 {
    let number = now.as_nanos().unsigned_abs() / MARKED_FOR.as_nanos() as u64;
    (number % MARKS) as f64 * MARK
}

/// When a value that is read back was written: so long ago at least, and at most, where the
/// same one was written several times in succession.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct WrittenAgo {
    pub(crate) least: Duration,
    pub(crate) most: Duration,
}

impl WrittenAgo {
    /// What two axes say together: both were written at the same time.
    pub(crate) fn with(self, other: Self) -> Self {
        Self {
            least: self.least.max(other.least),
            most: self.most.min(other.most),
        }
    }
}

/// The round trip of the last second that has passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundTrip {
    since: Time,
    longest: Option<WrittenAgo>,
    shown: Duration,
    /// How many times it was too long.
    too_long: u8,
}

impl RoundTrip {
    pub(crate) const fn begin(now: Time) -> Self {
        Self {
            since: now,
            longest: None,
            shown: Duration::ZERO,
            too_long: 0,
        }
    }

    /// The first round trip, of which is known when it began.
    pub(crate) fn is_at_first(&mut self, took: Duration) {
        if took > TOO_LONG {
            (self.shown, self.too_long) = (took, TIMES);
        }
    }

    pub(crate) fn add(&mut self, now: Time, took: WrittenAgo) {
        let longest = self.longest.take_if(|_| now.since(self.since) >= OVER);
        if let Some(WrittenAgo { least, most }) = longest {
            self.shown = least;
            if least > TOO_LONG {
                self.too_long = self.too_long.saturating_add(1);
            } else if most <= TOO_LONG {
                self.too_long = 0;
            }
        }
        if self.longest.is_none() {
            self.since = now;
        }
        let longest = self.longest.get_or_insert(took);
        longest.least = longest.least.max(took.least);
        longest.most = longest.most.max(took.most);
    }

    pub(crate) const fn shown(&self) -> Duration {
        self.shown
    }

    /// By how much what is read is too old to fly by; zero if it is not.
    pub(crate) fn too_late(&self) -> Duration {
        if self.too_long >= TIMES {
            self.shown.max(TOO_LONG)
        } else {
            Duration::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads back 40 times a second for some seconds.
    fn read(trip: &mut RoundTrip, from_s: u64, seconds: u64, least_ms: u64, most_ms: u64) {
        for tick in 0..40 * seconds {
            let now = Time::from_nanos(((from_s * 40 + tick) * 25_000_000) as i64);
            let took = WrittenAgo {
                least: Duration::from_millis(least_ms),
                most: Duration::from_millis(most_ms),
            };
            trip.add(now, took);
        }
    }

    #[test]
    fn a_long_round_trip_stays_too_long_until_a_changing_value_comes_back_in_time() {
        let mut trip = RoundTrip::begin(Time::from_nanos(0));
        read(&mut trip, 0, 2, 60, 80);
        assert_eq!(trip.too_late(), Duration::ZERO);
        read(&mut trip, 2, 4, 900, 920);
        assert_eq!(trip.too_late(), Duration::from_millis(900));
        // A value that is written unchanged may be the first or the last of them.
        read(&mut trip, 6, 4, 30, 2_000);
        assert_eq!(trip.too_late(), TOO_LONG);
        read(&mut trip, 10, 3, 60, 80);
        assert_eq!(trip.too_late(), Duration::ZERO);
    }
}
