//! Which clock has stamped an event, and when that was on the loop's.
//!
//! Android defines the time of an event on `CLOCK_BOOTTIME`
//! (`SystemClock.elapsedRealtimeNanos`); phones differ, and some stamp on
//! `CLOCK_MONOTONIC`, the loop's clock, which stands while the phone sleeps. A stamp is
//! of the past, and not of long ago: that tells which clock it is of, if the phone has
//! slept for longer than its events are under way. If it has not, the clocks show the
//! same.

use core::time::Duration;

use fcc_core::framework::Time;
use fcc_device::{Clock, DeviceError};
use nix::sys::time::TimeValLike;
use nix::time::{ClockId, clock_gettime};
use serde::Serialize;

use crate::library::refused;

/// A sensor's processor has a clock of its own, which is set by the phone's: it may be
/// ahead by this.
const MOST_AHEAD_NS: i64 = 2_000_000;
/// Android permits 100 ms from the event to the app (*Compatibility Definition*, 7.3).
/// A stamp that is older is of another clock.
const OLDEST_NS: i64 = 1_000_000_000;
/// Both clocks are read within this time, ns, if that can be had in three attempts.
const TOGETHER_NS: i64 = 20_000;

/// A clock that stamps events.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StampClock {
    /// `CLOCK_MONOTONIC`, the loop's.
    Monotonic,
    /// `CLOCK_BOOTTIME`, which goes on while the phone sleeps.
    Boottime,
}

/// The phone's clocks; others in tests.
#[derive(Clone, Debug)]
pub struct Clocks {
    /// The loop's.
    pub monotonic: Clock,
    /// The one that goes on while the phone sleeps.
    pub boottime: Clock,
}

impl Default for Clocks {
    fn default() -> Self {
        Self {
            monotonic: Clock::default(),
            boottime: Clock::new(|| {
                clock_gettime(ClockId::CLOCK_BOOTTIME)
                    .map_or(Time::NEVER, |now| Time::from_nanos(now.num_nanoseconds()))
            }),
        }
    }
}

/// Both clocks at one time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Now {
    pub(crate) monotonic: Time,
    /// How long the phone has slept, ns.
    slept_ns: i64,
}

impl Clocks {
    /// Reads both.
    pub(crate) fn now(&self) -> Now {
        let read = || {
            let before = self.monotonic.now();
            let boottime = self.boottime.now();
            let after = self.monotonic.now();
            let took_ns = after - before;
            let now = Now {
                monotonic: after,
                slept_ns: (boottime - before) - took_ns / 2,
            };
            (took_ns, now)
        };
        let mut best = read();
        for _ in 0..2 {
            if best.0 <= TOGETHER_NS {
                break;
            }
            let again = read();
            if again.0 < best.0 {
                best = again;
            }
        }
        best.1
    }
}

impl Now {
    /// When a stamp of `CLOCK_BOOTTIME` was on the loop's clock.
    pub(crate) fn boottime(self, stamp_ns: i64) -> Option<Time> {
        stamp_ns.checked_sub(self.slept_ns).map(Time::from_nanos)
    }
}

/// Whether an age is one of an event.
fn is_age(age_ns: i64) -> bool {
    (-MOST_AHEAD_NS..=OLDEST_NS).contains(&age_ns)
}

impl StampClock {
    /// The clock of stamps of which the youngest was so old on the loop's clock when it
    /// arrived; none if it is of neither clock.
    fn of(youngest_ns: i64, now: Now) -> Option<Self> {
        if is_age(youngest_ns) {
            return Some(Self::Monotonic);
        }
        is_age(youngest_ns.saturating_add(now.slept_ns)).then_some(Self::Boottime)
    }

    /// When a stamp was on the loop's clock; none if it is not of this clock.
    pub(crate) fn time(self, stamp_ns: i64, now: Now) -> Option<Time> {
        let taken = match self {
            Self::Monotonic => Time::from_nanos(stamp_ns),
            Self::Boottime => now.boottime(stamp_ns)?,
        };
        let age_ns = now.monotonic.as_nanos().checked_sub(taken.as_nanos())?;
        is_age(age_ns).then(|| taken.min(now.monotonic))
    }
}

/// The first events of a sensor, from which its clock and its rate are found.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Trial {
    events: u32,
    first_ns: i64,
    last_ns: i64,
    youngest_ns: Option<i64>,
    /// When the first one arrived.
    began: Option<Time>,
}

/// For so many events, and for so long.
const TRIAL_EVENTS: u32 = 10;
const TRIAL: Duration = Duration::from_millis(200);
/// Stamps that have not advanced by as much in this time stand still, or go back: a sensor
/// that waits for its batch gives them after 1 s at the latest, or has stalled.
const LONGEST_TRIAL: Duration = Duration::from_secs(3);

impl Trial {
    /// Takes an event that arrived now; clock and rate, Hz, when enough is known.
    ///
    /// # Errors
    /// When its stamps are of no known clock, or do not advance.
    pub(crate) fn take(
        &mut self,
        device: &'static str,
        stamp_ns: i64,
        now: Now,
    ) -> Result<Option<(StampClock, f64)>, DeviceError> {
        if self.events == 0 {
            self.first_ns = stamp_ns;
        }
        self.events += 1;
        self.last_ns = stamp_ns;
        let age_ns = now.monotonic.as_nanos().saturating_sub(stamp_ns);
        let youngest_ns = self.youngest_ns.map_or(age_ns, |least| least.min(age_ns));
        self.youngest_ns = Some(youngest_ns);
        if self.events < TRIAL_EVENTS {
            return Ok(None);
        }
        let Some(clock) = StampClock::of(youngest_ns, now) else {
            return Err(DeviceError::WrongClock {
                device: device.to_owned(),
                age_s: youngest_ns as f64 * 1e-9,
            });
        };
        let lasted_ns = self.last_ns.saturating_sub(self.first_ns);
        if lasted_ns < TRIAL.as_nanos() as i64 {
            let began = *self.began.get_or_insert(now.monotonic);
            if now.monotonic.since(began) > LONGEST_TRIAL {
                let what = format!(
                    "the time stamps of its events do not advance: {} s in {} s; end other apps, \
                     or start the phone again",
                    lasted_ns as f64 * 1e-9,
                    LONGEST_TRIAL.as_secs()
                );
                return Err(refused(device, what));
            }
            return Ok(None);
        }
        let rate_hz = f64::from(self.events - 1) / (lasted_ns as f64 * 1e-9);
        Ok(Some((clock, rate_hz)))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const MS: i64 = 1_000_000;
    const S: i64 = 1_000 * MS;

    fn now(monotonic_ns: i64, slept_ns: i64) -> Now {
        Now {
            monotonic: Time::from_nanos(monotonic_ns),
            slept_ns,
        }
    }

    /// Feeds 100 events a second that arrive late by `late_ns`.
    fn tried(slept_ns: i64, stamp_ahead_ns: i64, late_ns: i64) -> Result<StampClock, DeviceError> {
        let mut trial = Trial::default();
        for number in 0..100 {
            let taken_ns = 5_000 * S + number * 10 * MS;
            let found = trial.take(
                "test",
                taken_ns + stamp_ahead_ns,
                now(taken_ns + late_ns, slept_ns),
            )?;
            if let Some((clock, rate_hz)) = found {
                assert!((rate_hz - 100.0).abs() < 1e-6, "{rate_hz}");
                assert_eq!(number, 20, "200 ms");
                return Ok(clock);
            }
        }
        panic!("undecided");
    }

    #[test]
    fn the_clock_of_the_stamps_is_found() {
        let slept_ns = 7_200 * S;
        assert_eq!(tried(slept_ns, 0, 5 * MS).unwrap(), StampClock::Monotonic);
        let boottime = tried(slept_ns, slept_ns, 5 * MS).unwrap();
        assert_eq!(boottime, StampClock::Boottime);
        // Slept for 300 ms: an event on the loop's clock might as well be an old one.
        let short = 300 * MS;
        assert_eq!(tried(short, 0, 5 * MS).unwrap(), StampClock::Monotonic);
        assert_eq!(tried(short, short, 5 * MS).unwrap(), StampClock::Boottime);
    }

    #[test]
    fn stamps_of_another_clock_are_refused() {
        // The time of the day, a counter that begins at 0, 3 ms ahead.
        for ahead_ns in [1_800_000_000 * S, -5_000 * S, 8 * MS] {
            let wrong = tried(0, ahead_ns, 5 * MS).unwrap_err();
            assert!(matches!(wrong, DeviceError::WrongClock { .. }), "{wrong}");
        }
    }

    #[test]
    fn stamps_that_do_not_advance_are_refused() {
        for step_ns in [0, -10_000, 1_000] {
            let mut trial = Trial::default();
            let wrong = (0..1_000).find_map(|number| {
                let now = now(5_000 * S + number * 10 * MS, 0);
                // Younger than what is of another clock.
                let stamp_ns = now.monotonic.as_nanos().min(5_000 * S) + number * step_ns;
                trial
                    .take("test", stamp_ns, now)
                    .err()
                    .map(|wrong| (number, wrong))
            });
            let (number, wrong) = wrong.unwrap();
            assert!((300..320).contains(&number), "{number}");
            assert!(wrong.to_string().contains("do not advance"), "{wrong}");
        }
    }

    #[test]
    fn a_stamp_is_converted_to_the_loops_clock() {
        let now = now(5_000 * S, 7_200 * S);
        let taken = Time::from_nanos(5_000 * S - 5 * MS);
        let stamp_ns = 12_200 * S - 5 * MS;
        assert_eq!(StampClock::Boottime.time(stamp_ns, now), Some(taken));
        assert_eq!(
            StampClock::Monotonic.time(taken.as_nanos(), now),
            Some(taken)
        );
        assert_eq!(StampClock::Monotonic.time(stamp_ns, now), None);
        // A stamp that is a little ahead is now.
        let ahead = StampClock::Monotonic.time(5_000 * S + MS, now);
        assert_eq!(ahead, Some(now.monotonic));
    }

    #[test]
    fn the_clocks_of_this_machine_are_read_together() {
        let now = Clocks::default().now();
        let again = Clocks::default().now();
        assert!(again.monotonic >= now.monotonic);
        assert!((again.slept_ns - now.slept_ns).abs() < 50 * MS);
    }

    proptest! {
        /// Whatever a sensor stamps: no time of the future, nothing old, no overflow.
        #[test]
        fn a_time_is_never_of_the_future_or_old(
            stamp_ns in any::<i64>(), slept_ns in 0_i64..i64::MAX / 4
        ) {
            let now = now(5_000 * S, slept_ns);
            for clock in [StampClock::Monotonic, StampClock::Boottime] {
                if let Some(time) = clock.time(stamp_ns, now) {
                    prop_assert!(time <= now.monotonic);
                    prop_assert!(now.monotonic - time <= OLDEST_NS);
                }
            }
            let mut trial = Trial::default();
            for _ in 0..30 {
                if trial.take("test", stamp_ns, now).is_err() {
                    break;
                }
            }
        }
    }
}
