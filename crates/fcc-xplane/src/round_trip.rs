//! How long it takes from writing a value to reading it back.

use core::time::Duration;

use fcc_core::framework::Time;

/// Over such a time it is the longest that was seen: the same value may be written again
/// and again.
const OVER: Duration = Duration::from_secs(1);
/// No aircraft is flown over a longer round trip, if it was longer in so many of those times
/// in succession.
pub(crate) const TOO_LONG: Duration = Duration::from_millis(500);
const TIMES: u8 = 2;
/// ... by so many values at least, of three axes in 20 frames a second or more: after a freeze
/// of the simulator each shows once what was written before.
const LEAST: u16 = 15;

/// When a value that is read back was written: so long ago at least, and at most, where the
/// same one was written several times in succession.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct WrittenAgo {
    pub(crate) least: Duration,
    pub(crate) most: Duration,
}

/// The round trip of the last second that has passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundTrip {
    since: Time,
    longest: Duration,
    shown: Duration,
    /// How many values of this time came back too late, and how many in time.
    late: u16,
    in_time: u16,
    /// In how many times in succession more came too late.
    too_long: u8,
}

impl RoundTrip {
    pub(crate) const fn begin(now: Time) -> Self {
        Self {
            since: now,
            longest: Duration::ZERO,
            shown: Duration::ZERO,
            late: 0,
            in_time: 0,
            too_long: 0,
        }
    }

    /// The first round trip, of which is known when it began.
    pub(crate) fn is_at_first(&mut self, took: Duration) {
        if took > TOO_LONG {
            (self.shown, self.too_long) = (took, TIMES);
        }
    }

    /// Takes when what is read back was written. `changes` if it was read back otherwise before:
    /// what stands still may have done so for long.
    pub(crate) fn add(&mut self, now: Time, took: WrittenAgo, changes: bool) {
        if now.since(self.since) >= OVER {
            self.shown = self.longest;
            if self.late > self.in_time.max(LEAST) {
                self.too_long = self.too_long.saturating_add(1);
            } else if self.in_time > 0 {
                self.too_long = 0;
            }
            (self.since, self.longest) = (now, Duration::ZERO);
            (self.late, self.in_time) = (0, 0);
        }
        self.longest = self.longest.max(took.least);
        if changes && took.least > TOO_LONG {
            self.late = self.late.saturating_add(1);
        } else if changes && took.most <= TOO_LONG {
            self.in_time = self.in_time.saturating_add(1);
        }
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
    fn read(
        trip: &mut RoundTrip,
        (from_s, seconds): (u64, u64),
        (least_ms, most_ms): (u64, u64),
        changes: bool,
    ) {
        for tick in 0..40 * seconds {
            let now = Time::from_nanos(((from_s * 40 + tick) * 25_000_000) as i64);
            let took = WrittenAgo {
                least: Duration::from_millis(least_ms),
                most: Duration::from_millis(most_ms),
            };
            trip.add(now, took, changes);
        }
    }

    #[test]
    fn a_long_round_trip_stays_too_long_until_a_changing_value_comes_back_in_time() {
        let mut trip = RoundTrip::begin(Time::from_nanos(0));
        read(&mut trip, (0, 2), (60, 80), true);
        assert_eq!(trip.too_late(), Duration::ZERO);
        read(&mut trip, (2, 4), (900, 920), true);
        assert_eq!(trip.too_late(), Duration::from_millis(900));
        // A value that is written unchanged may be the first or the last of them.
        read(&mut trip, (6, 4), (30, 2_000), false);
        assert_eq!(trip.too_late(), TOO_LONG);
        // Nor is one that stands still older than it was.
        let mut still = RoundTrip::begin(Time::from_nanos(0));
        read(&mut still, (0, 6), (900, 920), false);
        assert_eq!(still.too_late(), Duration::ZERO);
        read(&mut trip, (10, 3), (60, 80), true);
        assert_eq!(trip.too_late(), Duration::ZERO);
    }
}
