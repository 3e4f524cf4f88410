//! Timing statistics in fixed memory.

mod deviation;
mod summary;

use hdrhistogram::{CreationError, Histogram};
use std::time::Duration;

use crate::deadlines::Period;
use crate::{Expiry, TimerError};
use deviation::Deviations;
pub use summary::TimingSummary;

/// Significant figures of a histogram: 100 µs is stored to 0.1 µs.
pub(crate) const FIGURES: u8 = 3;
const NS_PER_US: f64 = 1e3;
const NS_PER_MS: f64 = 1e6;
/// What a histogram can hold, in periods. Longer counts as this long; minimum,
/// maximum and mean are kept beside the histogram and know no limit.
const LONGEST_PERIODS: u64 = 64;

/// Periods and lateness of a timer, counted tick by tick.
///
/// Two different quantities, both recorded:
/// - *lateness*, when the thread woke minus when it was due;
/// - *period*, when the thread woke minus when it woke before. A thread that is
///   always 1 ms late has perfect periods.
///
/// Ticks, misses, mean, minimum, maximum and the share within 2 % are exact.
/// The quantiles come from histograms: lateness to 0.1 % of itself, and the
/// median period to 0.1 % *of its distance from the nominal period*, which is
/// better than 1 µs as long as the median is less than 1 ms away.
///
/// All memory is allocated, and touched, when the value is made: about 240 KiB
/// at 40 Hz, 450 KiB at most. [`record`](Self::record) allocates none.
#[derive(Clone, Debug)]
pub struct TimingStats {
    period: Period,
    ticks: u64,
    missed: u64,
    /// The deadline before the first that was recorded.
    began_ns: i64,
    /// When the first period counted began, as if none had been left out.
    first_woke_ns: i64,
    last_woke_ns: i64,
    periods: u64,
    /// Whether the next period is to be left out.
    interrupted: bool,
    period_min_ns: i64,
    period_max_ns: i64,
    within_2_percent: u64,
    deviations: Deviations,
    lateness_max_ns: i64,
    lateness: Histogram<u32>,
    early_wake_ns: u64,
    early_wake_max_ns: u64,
    spun_ns: u64,
}

impl TimingStats {
    /// Makes empty statistics for a nominal period.
    ///
    /// # Errors
    /// When the period is not between 10 µs and 1 hour.
    pub fn new(period: Duration) -> Result<Self, TimerError> {
        let bad_bounds = |_: CreationError| TimerError::Period(period);
        let period_ns = Period::new(period)?.ns() as u64;
        let longest_ns = LONGEST_PERIODS * period_ns;
        let mut stats = Self {
            period: Period::new(period)?,
            ticks: 0,
            missed: 0,
            began_ns: 0,
            first_woke_ns: 0,
            last_woke_ns: 0,
            periods: 0,
            interrupted: false,
            period_min_ns: i64::MAX,
            period_max_ns: i64::MIN,
            within_2_percent: 0,
            deviations: Deviations::new(period_ns, longest_ns).map_err(bad_bounds)?,
            lateness_max_ns: 0,
            lateness: Histogram::new_with_bounds(1, longest_ns, FIGURES).map_err(bad_bounds)?,
            early_wake_ns: 0,
            early_wake_max_ns: 0,
            spun_ns: 0,
        };
        // Zeroed memory is not backed by pages until it is written to.
        stats.reset();
        Ok(stats)
    }

    /// Resets all statistics. Allocates nothing.
    pub fn reset(&mut self) {
        self.ticks = 0;
        self.missed = 0;
        self.periods = 0;
        self.interrupted = false;
        self.period_min_ns = i64::MAX;
        self.period_max_ns = i64::MIN;
        self.within_2_percent = 0;
        self.lateness_max_ns = 0;
        self.deviations.reset();
        self.lateness.reset();
        self.early_wake_ns = 0;
        self.early_wake_max_ns = 0;
        self.spun_ns = 0;
    }

    /// Counts a tick. Allocates nothing.
    pub fn record(&mut self, expiry: &Expiry) {
        if self.ticks == 0 {
            self.began_ns = expiry.scheduled_ns.saturating_sub(self.period.ns());
            self.first_woke_ns = expiry.woke_ns;
        } else {
            let period_ns = expiry.woke_ns.saturating_sub(self.last_woke_ns);
            if self.interrupted {
                self.first_woke_ns = self.first_woke_ns.saturating_add(period_ns);
            } else {
                self.record_period(period_ns);
            }
        }
        self.interrupted = false;
        self.last_woke_ns = expiry.woke_ns;
        self.ticks = self.ticks.saturating_add(1);
        self.missed = self.missed.saturating_add(expiry.missed);

        // For the first period that it served or missed.
        let missed_ns = self.period.ns().saturating_mul(expiry.missed as i64);
        let lateness_ns = expiry.lateness_ns().max(0).saturating_add(missed_ns);
        self.lateness_max_ns = self.lateness_max_ns.max(lateness_ns);
        self.lateness.saturating_record(lateness_ns.unsigned_abs());
        self.early_wake_ns = expiry.early_wake_ns;
        self.early_wake_max_ns = self.early_wake_max_ns.max(expiry.early_wake_ns);
        self.spun_ns = self.spun_ns.saturating_add(expiry.spun_ns);
    }

    /// Marks that ticks are missing before the next one: the time until then is
    /// not counted as a period. Allocates nothing.
    pub fn interrupt(&mut self) {
        self.interrupted = true;
    }

    fn record_period(&mut self, period_ns: i64) {
        self.periods = self.periods.saturating_add(1);
        self.period_min_ns = self.period_min_ns.min(period_ns);
        self.period_max_ns = self.period_max_ns.max(period_ns);
        let deviation_ns = period_ns.saturating_sub(self.period.ns());
        // 2 % of the nominal period is a fiftieth.
        if deviation_ns.saturating_abs().saturating_mul(50) <= self.period.ns() {
            self.within_2_percent = self.within_2_percent.saturating_add(1);
        }
        self.deviations.record(deviation_ns);
    }

    /// The nominal period.
    #[must_use]
    pub const fn period(&self) -> Duration {
        self.period.duration()
    }

    /// The statistics so far.
    #[must_use]
    pub fn summary(&self) -> TimingSummary {
        TimingSummary::of(self)
    }

    /// Every period measured, ms, with how often, shortest first: to draw their
    /// distribution. As exact as the median.
    pub fn period_counts(&self) -> impl Iterator<Item = (f64, u64)> {
        let (min, max) = (self.period_min_ns as f64, self.period_max_ns as f64);
        self.deviations.counts().map(move |(deviation_ns, count)| {
            let period_ns = self.period.ns() as f64 + deviation_ns;
            (period_ns.max(min).min(max) / NS_PER_MS, count)
        })
    }

    /// Every lateness measured, µs, with how often, smallest first; each to
    /// 0.1 % of itself.
    pub fn lateness_counts(&self) -> impl Iterator<Item = (f64, u64)> {
        let max = self.lateness_max_ns as f64;
        deviation::counts(&self.lateness).map(move |(ns, count)| (ns.min(max) / NS_PER_US, count))
    }

    /// Periods measured: one less than ticks, if none was left out.
    fn periods(&self) -> u64 {
        self.periods
    }
}

#[cfg(test)]
mod tests;
