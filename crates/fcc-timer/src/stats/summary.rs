//! The figures for reports.

use super::{NS_PER_MS, NS_PER_US, TimingStats};

const NS_PER_S: f64 = 1e9;

/// The figures of [`TimingStats`]: those of the thesis' table of a control loop's
/// timing (runtime, average, median, minimum, maximum, range, missed), and the
/// lateness, which it did not measure.
///
/// Figures of periods are NaN before the second tick, those of lateness before
/// the first.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TimingSummary {
    /// Nominal rate, Hz.
    pub rate_hz: f64,
    /// Deadlines served.
    pub ticks: u64,
    /// Deadlines passed unserved.
    pub missed: u64,
    /// From one period before the first deadline recorded to the last wake-up,
    /// s: the time that the ticks and the misses stand for.
    pub runtime_s: f64,
    /// Mean period, ms.
    pub period_mean_ms: f64,
    /// Median period, ms.
    pub period_median_ms: f64,
    /// Shortest period, ms.
    pub period_min_ms: f64,
    /// Longest period, ms.
    pub period_max_ms: f64,
    /// Longest minus shortest period, ms.
    pub period_range_ms: f64,
    /// Fraction of the periods within ±2 % of the nominal one, 0..1.
    pub period_within_2_percent: f64,
    /// Lateness that half of the wake-ups stay within, µs.
    pub lateness_p50_us: f64,
    /// Lateness that 99 % of the wake-ups stay within, µs.
    pub lateness_p99_us: f64,
    /// Lateness that 99.9 % of the wake-ups stay within, µs.
    pub lateness_p99_9_us: f64,
    /// Lateness of the latest wake-up, µs.
    pub lateness_max_us: f64,
    /// How long before its deadline the last wake-up was requested, µs; 0 without
    /// early wake.
    pub early_wake_us: f64,
    /// The longest such margin, µs.
    pub early_wake_max_us: f64,
    /// Time spent spinning towards deadlines, s.
    pub spun_s: f64,
}

impl TimingSummary {
    pub(super) fn of(stats: &TimingStats) -> Self {
        let nominal_ns = stats.period.ns();
        let since_first_ns = stats.last_woke_ns.saturating_sub(stats.first_woke_ns);
        let of_periods = |ns: f64| {
            if stats.periods() == 0 { f64::NAN } else { ns }
        };
        let of_ticks = |ns: f64| if stats.ticks == 0 { f64::NAN } else { ns };
        // A histogram returns the middle of a range, which may lie outside of
        // the exact limits.
        let lateness_us = |quantile: f64| {
            let histogram = &stats.lateness;
            let value = histogram.median_equivalent(histogram.value_at_quantile(quantile));
            of_ticks(value.min(stats.lateness_max_ns.unsigned_abs()) as f64) / NS_PER_US
        };
        let median_ns = |deviation_ns: f64| {
            (nominal_ns as f64 + deviation_ns)
                .max(stats.period_min_ns as f64)
                .min(stats.period_max_ns as f64)
        };
        Self {
            rate_hz: NS_PER_S / nominal_ns as f64,
            ticks: stats.ticks,
            missed: stats.missed,
            runtime_s: if stats.ticks == 0 {
                0.0
            } else {
                stats.last_woke_ns.saturating_sub(stats.began_ns) as f64 / NS_PER_S
            },
            period_mean_ms: of_periods(since_first_ns as f64) / stats.periods() as f64 / NS_PER_MS,
            period_median_ms: stats.deviations.median().map_or(f64::NAN, median_ns) / NS_PER_MS,
            period_min_ms: of_periods(stats.period_min_ns as f64) / NS_PER_MS,
            period_max_ms: of_periods(stats.period_max_ns as f64) / NS_PER_MS,
            period_range_ms: of_periods(
                stats.period_max_ns.saturating_sub(stats.period_min_ns) as f64
            ) / NS_PER_MS,
            period_within_2_percent: of_periods(stats.within_2_percent as f64)
                / stats.periods() as f64,
            lateness_p50_us: lateness_us(0.5),
            lateness_p99_us: lateness_us(0.99),
            lateness_p99_9_us: lateness_us(0.999),
            lateness_max_us: of_ticks(stats.lateness_max_ns as f64) / NS_PER_US,
            early_wake_us: stats.early_wake_ns as f64 / NS_PER_US,
            early_wake_max_us: stats.early_wake_max_ns as f64 / NS_PER_US,
            spun_s: stats.spun_ns as f64 / NS_PER_S,
        }
    }
}
