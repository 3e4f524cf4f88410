//! Computes the figures from the times of ticks, in the same way for all.
//!
//! A peer's ticks are compared with its own grid: the nominal period from its
//! start. *Drift* is what a clock gains or loses against `CLOCK_MONOTONIC`,
//! measured at the lower edge, where nothing delayed a tick. *Lateness* is how
//! far a tick is behind the grid on which the earliest tick is on time. There
//! are two: against the monotonic clock, including drift (`lateness_us`), and
//! without drift (`undrifted_us`), which favours a clock that runs at another
//! speed. The *period error* needs no grid: how far the time between two ticks
//! differs from a period (or several, if some were skipped).

use serde::{Deserialize, Serialize};

/// A period counts as kept within this share of itself.
const KEPT_WITHIN: f64 = 0.02;
/// How much earlier than the earliest recent tick a tick may be and still count
/// as the next one, in periods.
const TOLERANCE: f64 = 0.1;
/// Number of earlier ticks among which the earliest is searched.
const RECENT_TICKS: usize = 32;

/// The distribution of times, µs.
#[derive(Serialize, Deserialize, Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct Spread {
    pub(crate) p50: f64,
    pub(crate) p99: f64,
    pub(crate) p99_9: f64,
    pub(crate) max: f64,
}

/// The figures of one run of a peer.
#[derive(Serialize, Deserialize, Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct Figures {
    pub(crate) ticks: usize,
    /// Periods without a tick.
    pub(crate) missed: u64,
    pub(crate) lateness_us: Spread,
    pub(crate) undrifted_us: Spread,
    /// |time between two ticks - period|.
    pub(crate) period_error_us: Spread,
    /// Share of periods within ±2 %, %.
    pub(crate) kept_percent: f64,
    /// Drift per second, µs.
    pub(crate) drift_us_per_s: f64,
    /// Lateness of the earliest tick, µs, if the peer reports the origin of its
    /// deadlines.
    pub(crate) earliest_us: Option<f64>,
    /// CPU time, % of a core.
    pub(crate) cpu_percent: f64,
}

impl Figures {
    /// The figures of ticks at these times, ns; `None` of fewer than three.
    pub(crate) fn of(ticks_ns: &[i64], period_ns: i64, origin_ns: Option<i64>) -> Option<Self> {
        let (&first, &last) = (ticks_ns.first()?, ticks_ns.last()?);
        if ticks_ns.len() < 3 {
            return None;
        }
        let numbers = grid_numbers(ticks_ns, period_ns);
        let behind_us: Vec<f64> = ticks_ns
            .iter()
            .zip(&numbers)
            .map(|(tick, number)| (tick - first - number * period_ns) as f64 / 1e3)
            .collect();
        let drift_us_per_s = drift(&behind_us, (last - first) as f64 / 1e9);
        let seconds = |tick: i64| (tick - first) as f64 / 1e9;
        let undrifted_us = ticks_ns
            .iter()
            .zip(&behind_us)
            .map(|(&tick, behind)| behind - drift_us_per_s * seconds(tick));

        let steps = ticks_ns.windows(2).zip(numbers.windows(2));
        let errors_us: Vec<f64> = steps
            .map(|(tick, number)| {
                let periods = (number[1] - number[0]).max(1);
                (tick[1] - tick[0] - periods * period_ns).abs() as f64 / 1e3
            })
            .collect();
        let kept = ticks_ns
            .windows(2)
            .filter(|pair| {
                let error_ns = (pair[1] - pair[0] - period_ns).abs() as f64;
                error_ns <= KEPT_WITHIN * period_ns as f64
            })
            .count();
        let span = numbers
            .last()
            .zip(numbers.first())
            .map_or(0, |(l, f)| l - f);
        let earliest_us = origin_ns.map(|origin| {
            let phase = (first - origin).rem_euclid(period_ns) as f64 / 1e3;
            let whole_us = period_ns as f64 / 1e3;
            let phase = if phase > (1.0 - TOLERANCE) * whole_us {
                phase - whole_us
            } else {
                phase
            };
            phase + least(behind_us.iter().copied())
        });
        Some(Self {
            ticks: ticks_ns.len(),
            missed: (span + 1 - ticks_ns.len() as i64).max(0).unsigned_abs(),
            lateness_us: Spread::above_least(behind_us.iter().copied()),
            undrifted_us: Spread::above_least(undrifted_us),
            period_error_us: Spread::of(errors_us),
            kept_percent: 100.0 * kept as f64 / (ticks_ns.len() - 1) as f64,
            drift_us_per_s,
            earliest_us,
            cpu_percent: 0.0,
        })
    }
}

impl Spread {
    fn above_least(values: impl Iterator<Item = f64> + Clone) -> Self {
        let least = least(values.clone());
        Self::of(values.map(|value| value - least).collect())
    }

    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        // The smallest value that this share does not exceed: nearest rank.
        let at = |share: f64| {
            let rank = (share * values.len() as f64).ceil() as usize;
            values.get(rank.max(1) - 1).copied().unwrap_or(0.0)
        };
        Self {
            p50: at(0.5),
            p99: at(0.99),
            p99_9: at(0.999),
            max: at(1.0),
        }
    }
}

/// The number of the deadline on the grid for each tick, from 0.
///
/// The grid follows the earliest of the last ticks, so that a clock may drift
/// from the nominal grid by many periods. A tick that is nearly a period late
/// looks like an early next one, until the next one comes too.
fn grid_numbers(ticks_ns: &[i64], period_ns: i64) -> Vec<i64> {
    let tolerance_ns = (TOLERANCE * period_ns as f64) as i64;
    let mut numbers: Vec<i64> = Vec::with_capacity(ticks_ns.len());
    let mut behind_ns: Vec<i64> = Vec::with_capacity(ticks_ns.len());
    for &tick in ticks_ns {
        let recent = &behind_ns[behind_ns.len().saturating_sub(RECENT_TICKS)..];
        let grid_ns = recent.iter().min().copied().unwrap_or(tick);
        let mut number = (tick - grid_ns + tolerance_ns).div_euclid(period_ns);
        if let Some(&before) = numbers.last() {
            number = number.max(before);
            if number == before {
                let late = numbers.len() - 1;
                numbers[late] -= 1;
                behind_ns[late] += period_ns;
            }
        }
        numbers.push(number);
        behind_ns.push(tick - number * period_ns);
    }
    let first = numbers.first().copied().unwrap_or(0);
    for number in &mut numbers {
        *number -= first;
    }
    numbers
}

/// How fast the lower edge rises, per second, from the first quarter of a run
/// to the last.
fn drift(behind_us: &[f64], run_s: f64) -> f64 {
    let quarter = (behind_us.len() / 4).max(1);
    let lowest = |part: &[f64]| least(part.iter().copied());
    let rise = lowest(&behind_us[behind_us.len() - quarter..]) - lowest(&behind_us[..quarter]);
    rise / (0.75 * run_s)
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, f64::min)
}

/// The median; the mean of the two middle values of an even number; 0 of none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        odd if odd % 2 == 1 => values[odd / 2],
        even => f64::midpoint(values[even / 2 - 1], values[even / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn close(got: f64, expected: f64) {
        assert!((got - expected).abs() < 1e-6, "{got} is not {expected}");
    }

    #[test]
    fn a_perfect_clock_is_never_late() {
        let ticks: Vec<i64> = (0..100).map(|k| 7 + 25 * MS * k).collect();
        let figures = Figures::of(&ticks, 25 * MS, Some(0)).unwrap();
        assert_eq!(figures.lateness_us, Spread::default());
        assert_eq!(figures.period_error_us, Spread::default());
        close(figures.kept_percent, 100.0);
        close(figures.drift_us_per_s, 0.0);
        close(figures.earliest_us.unwrap(), 0.007);
        assert_eq!(figures.missed, 0);
    }

    #[test]
    fn one_tick_of_a_hundred_late_is_the_largest_and_not_p99() {
        let mut ticks: Vec<i64> = (0..100).map(|k| 25 * MS * k).collect();
        ticks[50] += 3 * MS;
        let figures = Figures::of(&ticks, 25 * MS, None).unwrap();
        close(figures.lateness_us.p99, 0.0);
        close(figures.lateness_us.max, 3_000.0);
        // The period before it was too long, the one after too short.
        close(figures.kept_percent, 100.0 * 97.0 / 99.0);
        close(figures.period_error_us.max, 3_000.0);
    }

    #[test]
    fn a_clock_that_is_slow_drifts_and_is_late_by_it() {
        // 50 µs in each second, and 10 s of it.
        let ticks: Vec<i64> = (0..=10_000).map(|k| (MS + 50) * k).collect();
        let figures = Figures::of(&ticks, MS, None).unwrap();
        assert!((figures.drift_us_per_s - 50.0).abs() < 0.1, "{figures:?}");
        close(figures.lateness_us.max, 500.0);
        assert!(figures.undrifted_us.max < 1.0, "{figures:?}");
        close(figures.period_error_us.p50, 0.05);
    }

    #[test]
    fn a_clock_that_drifts_by_periods_has_missed_nothing() {
        for step in [MS + MS / 500, MS - MS / 500] {
            let ticks: Vec<i64> = (0..5_000).map(|k| step * k).collect();
            let figures = Figures::of(&ticks, MS, None).unwrap();
            assert_eq!(figures.missed, 0, "{step}");
        }
    }

    #[test]
    fn what_is_skipped_is_missed_and_the_rest_is_on_time() {
        let ticks = [0, 10, 20, 60, 70, 80].map(|ms| ms * MS);
        let figures = Figures::of(&ticks, 10 * MS, None).unwrap();
        assert_eq!(figures.missed, 3);
        close(figures.lateness_us.max, 0.0);
        close(figures.kept_percent, 80.0);
    }

    #[test]
    fn nearly_a_period_late_is_late() {
        // Ticks due at 20 and 30 ms at 29.6 and 30 ms.
        let mut ticks: Vec<i64> = (0..10).map(|k| 10 * MS * k).collect();
        ticks[2] = 29_600_000;
        let figures = Figures::of(&ticks, 10 * MS, None).unwrap();
        assert_eq!(figures.missed, 0);
        close(figures.lateness_us.max, 9_600.0);
    }

    #[test]
    fn a_median_is_the_middle() {
        close(median(vec![3.0, 1.0, 2.0]), 2.0);
        close(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        close(median(Vec::new()), 0.0);
    }
}
