//! The kernel's periodic tick, and a grid of deadlines that avoids it.
//!
//! While a thread runs, the kernel interrupts it `CONFIG_HZ` times a second
//! for its accounting: 2 to 20 µs each, more on a small board. Such a tick
//! sometimes interrupts a thread that spins until its deadline; if the period is
//! a multiple of the tick's, it does so always or never, depending on when the
//! timer started. So that time is chosen.
//!
//! The kernel's coarse clock advances with each tick, and its resolution is the
//! tick's period: `clock_getres(2)`, `time(7)`. Reading it requires neither a
//! right nor a file. One CPU advances it, and the others tick at the same times,
//! unless the kernel was configured to spread them (`skew_tick=1`): then the
//! grid may coincide with the ticks of the loop's CPU.

use nix::sys::time::TimeValLike as _;
use nix::time::{ClockId, clock_getres, clock_gettime};

use crate::deadlines::monotonic_ns;

/// Ticks that are observed; the most precise observation is used.
const WATCHED: u32 = 3;
/// Plausible tick periods: 1 kHz to 24 Hz; the kernel's range is 1000 to 100 Hz.
const PERIODS_NS: std::ops::RangeInclusive<i64> = 900_000..=42_000_000;
/// Least time between a tick and a wake-up or deadline. Less gains nothing: the
/// tick's own work may take that long.
const LEAST_ROOM_NS: i64 = 50_000;

/// The kernel's periodic tick: at `phase_ns + n * period_ns`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct KernelTick {
    period_ns: i64,
    phase_ns: i64,
}

/// One reading of the coarse clock, with the time before and after.
#[derive(Clone, Copy, Debug)]
struct Look {
    before_ns: i64,
    coarse_ns: i64,
    after_ns: i64,
}

impl KernelTick {
    /// Observes the coarse clock for three ticks: 12 ms at 250 Hz, at most twice
    /// as long. `None` if it does not advance as expected.
    pub(super) fn find() -> Option<Self> {
        let resolution = clock_getres(ClockId::CLOCK_MONOTONIC_COARSE).ok()?;
        let period_ns = resolution.num_nanoseconds();
        if !PERIODS_NS.contains(&period_ns) {
            return None;
        }
        Self::watch(period_ns, || {
            Some(Look {
                before_ns: monotonic_ns(),
                coarse_ns: coarse_now_ns()?,
                after_ns: monotonic_ns(),
            })
        })
    }

    fn watch(period_ns: i64, mut look: impl FnMut() -> Option<Look>) -> Option<Self> {
        let mut previous = look()?;
        let give_up_ns = previous
            .before_ns
            .saturating_add(2 * i64::from(WATCHED) * period_ns);
        let mut best: Option<(i64, i64)> = None;
        let mut seen = 0;
        while seen < WATCHED && previous.after_ns < give_up_ns {
            let now = look()?;
            if now.coarse_ns != previous.coarse_ns {
                seen += 1;
                // The tick was between these readings; the closer they are, the
                // more precisely its time is known.
                let uncertainty_ns = now.after_ns.saturating_sub(previous.before_ns);
                if best.is_none_or(|(least_ns, _)| uncertainty_ns < least_ns) {
                    best = Some((uncertainty_ns, previous.before_ns));
                }
            }
            previous = now;
        }
        let (_, at_ns) = best?;
        Some(Self {
            period_ns,
            phase_ns: at_ns.rem_euclid(period_ns),
        })
    }

    /// The first start from `earliest_ns` on for which no tick falls between the
    /// alarm, `margin_ns` before each deadline of a grid of `period_ns`, and the
    /// deadline, with the same distance to a tick on both sides. `earliest_ns`
    /// itself if no grid avoids the ticks.
    pub(super) fn clear_start_ns(self, earliest_ns: i64, period_ns: i64, margin_ns: i64) -> i64 {
        // Relative to the ticks, deadlines fall on every multiple of this.
        let step_ns = greatest_common_divisor(period_ns, self.period_ns);
        let room_ns = (step_ns - margin_ns) / 2;
        if room_ns < LEAST_ROOM_NS {
            return earliest_ns;
        }
        let after_tick_ns = margin_ns + room_ns;
        let wait_ns = (self.phase_ns + after_tick_ns - earliest_ns).rem_euclid(step_ns);
        earliest_ns.saturating_add(wait_ns)
    }
}

fn coarse_now_ns() -> Option<i64> {
    let now = clock_gettime(ClockId::CLOCK_MONOTONIC_COARSE).ok()?;
    Some(now.num_nanoseconds())
}

/// Of two positive numbers, by Euclid's algorithm.
const fn greatest_common_divisor(one: i64, other: i64) -> i64 {
    let (mut one, mut other) = (one, other);
    while other > 0 {
        (one, other) = (other, one % other);
    }
    one
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    /// 250 ticks in a second, as Debian's kernels have them, 3.9 ms after each
    /// multiple of 4 ms.
    const DEBIAN: KernelTick = KernelTick {
        period_ns: 4 * MS,
        phase_ns: 3_900_000,
    };

    /// How long after the tick before it a time is.
    fn after_tick_ns(tick: KernelTick, at_ns: i64) -> i64 {
        (at_ns - tick.phase_ns).rem_euclid(tick.period_ns)
    }

    #[test]
    fn no_tick_comes_between_alarm_and_deadline() {
        let margin_ns = 250_000;
        for (tick, period_ns) in [
            (DEBIAN, 25 * MS),
            (DEBIAN, 20 * MS),
            (DEBIAN, 10 * MS),
            (DEBIAN, MS),
            // A kernel with 1000 ticks in a second, one with 100.
            (
                KernelTick {
                    period_ns: MS,
                    phase_ns: 0,
                },
                25 * MS,
            ),
            (
                KernelTick {
                    period_ns: 10 * MS,
                    phase_ns: 9_999_999,
                },
                25 * MS,
            ),
        ] {
            for earliest_ns in [0, 1, 123_456_789, 987_654_321_012_345] {
                let start_ns = tick.clear_start_ns(earliest_ns, period_ns, margin_ns);
                assert!((0..10 * MS).contains(&(start_ns - earliest_ns)));
                for number in 1..200 {
                    let due_ns = after_tick_ns(tick, start_ns + number * period_ns);
                    assert!(
                        due_ns >= margin_ns + LEAST_ROOM_NS
                            && due_ns <= tick.period_ns - LEAST_ROOM_NS,
                        "{tick:?}, every {period_ns} ns: {due_ns} ns after a tick"
                    );
                }
            }
        }
    }

    #[test]
    fn forty_hertz_beside_250_ticks_stand_in_the_middle_of_a_millisecond() {
        // 25 ms after a tick is 1 ms after a tick, then 2, 3 and 0: so alarm and
        // deadline, 0.25 ms apart, have 0.375 ms on both sides.
        let start_ns = DEBIAN.clear_start_ns(0, 25 * MS, 250_000);
        assert_eq!(after_tick_ns(DEBIAN, start_ns) % MS, 625_000);
    }

    #[test]
    fn a_period_that_meets_the_tick_at_every_phase_starts_at_once() {
        // 60 Hz in whole nanoseconds has no divisor in common with 4 ms.
        assert_eq!(DEBIAN.clear_start_ns(77, 16_666_667, 250_000), 77);
        // Nor is there room in 0.1 ms, the divisor of 4 ms and 0.7 ms.
        assert_eq!(DEBIAN.clear_start_ns(77, 700_000, 20_000), 77);
    }

    #[test]
    fn the_divisor_is_that_of_euclid() {
        // Elements, book VII, proposition 2, with the numbers of Knuth, The Art
        // of Computer Programming, 1.1: 544 and 119.
        assert_eq!(greatest_common_divisor(544, 119), 17);
        assert_eq!(greatest_common_divisor(119, 544), 17);
        assert_eq!(greatest_common_divisor(4 * MS, 25 * MS), MS);
    }

    #[test]
    fn an_imprecise_measurement_does_not_count_as_precise() {
        // A look each 100 ns; ticks at 3.9 ms after multiples of 4. The first
        // two were missed: the clock was not read for 0.7 ms.
        let mut now_ns = 0_i64;
        let mut absences = vec![8_600_000, 4_600_000];
        let look = || {
            now_ns += 100;
            if let Some(&until_ns) = absences.last()
                && now_ns >= until_ns - 701_000
                && now_ns < until_ns
            {
                now_ns = until_ns;
                absences.pop();
            }
            let coarse_ns = (now_ns - DEBIAN.phase_ns).div_euclid(4 * MS) * 4 * MS;
            Some(Look {
                before_ns: now_ns,
                coarse_ns,
                after_ns: now_ns + 50,
            })
        };
        let found = KernelTick::watch(4 * MS, look).unwrap();
        let apart_ns = (found.phase_ns - DEBIAN.phase_ns).abs();
        assert!(apart_ns <= 200, "{found:?}");
    }

    #[test]
    fn a_clock_that_does_not_advance_has_no_tick() {
        let mut now_ns = 0;
        let stuck = || {
            now_ns += 1_000;
            Some(Look {
                before_ns: now_ns,
                coarse_ns: 7,
                after_ns: now_ns,
            })
        };
        assert_eq!(KernelTick::watch(4 * MS, stuck), None);
    }

    #[test]
    fn the_phase_of_this_machines_tick_is_constant() {
        // A machine that is elsewhere blurs a look; five of forty agree.
        let mut looks: Vec<KernelTick> = Vec::new();
        for _ in 0..40 {
            let Some(look) = KernelTick::find() else {
                continue;
            };
            let agreeing = looks.iter().filter(|other| {
                let apart_ns = (other.phase_ns - look.phase_ns).rem_euclid(look.period_ns);
                apart_ns.min(look.period_ns - apart_ns) < look.period_ns / 8
            });
            if agreeing.count() >= 4 {
                return;
            }
            looks.push(look);
        }
        // Nothing to find is an answer, too: a kernel whose coarse clock is fine.
        assert!(looks.is_empty(), "the tick moves about: {looks:?}");
    }
}
