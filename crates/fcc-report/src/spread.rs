//! Percentiles of durations, in fixed memory.

use hdrhistogram::Histogram;
use serde::Serialize;

/// Longer durations count as this in the percentiles, ns: ten minutes.
const LONGEST_NS: u64 = 600_000_000_000;
const NS_PER_US: f64 = 1e3;
/// A value of 100 µs is kept to 0.1 µs.
const FIGURES: u8 = 3;

/// Counts durations.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    histogram: Histogram<u32>,
    longest_ns: u64,
}

/// Percentiles of durations, each within 0.1 %.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Percentiles {
    /// Number of durations.
    pub count: u64,
    /// Median, µs.
    pub p50_us: f64,
    /// 90th percentile, µs.
    pub p90_us: f64,
    /// 99th percentile, µs.
    pub p99_us: f64,
    /// 99.9th percentile, µs.
    pub p99_9_us: f64,
    /// Largest, µs; exact.
    pub max_us: f64,
}

impl Default for Spread {
    #[expect(
        clippy::expect_used,
        reason = "bounds and figures are constants that the histogram takes"
    )]
    fn default() -> Self {
        Self {
            histogram: Histogram::new_with_bounds(1, LONGEST_NS, FIGURES)
                .expect("1 ns to 10 minutes in 3 figures is a histogram"),
            longest_ns: 0,
        }
    }
}

impl Spread {
    pub(super) fn record(&mut self, duration_ns: u64) {
        self.longest_ns = self.longest_ns.max(duration_ns);
        self.histogram.saturating_record(duration_ns);
    }

    /// `None` if nothing was recorded.
    pub(super) fn percentiles(&self) -> Option<Percentiles> {
        let histogram = &self.histogram;
        let us = |quantile: f64| {
            let value = histogram.median_equivalent(histogram.value_at_quantile(quantile));
            value.min(self.longest_ns) as f64 / NS_PER_US
        };
        (!histogram.is_empty()).then(|| Percentiles {
            count: histogram.len(),
            p50_us: us(0.5),
            p90_us: us(0.9),
            p99_us: us(0.99),
            p99_9_us: us(0.999),
            max_us: self.longest_ns as f64 / NS_PER_US,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 1 to 1000 µs, calculated: the smallest value that this share of them
    /// does not exceed.
    #[test]
    fn percentiles_of_a_thousand_durations() {
        let mut spread = Spread::default();
        assert_eq!(spread.percentiles(), None);
        for us in 1..=1_000 {
            spread.record(us * 1_000);
        }
        let of = spread.percentiles().unwrap();
        for (value, expected) in [
            (of.p50_us, 500.0),
            (of.p90_us, 900.0),
            (of.p99_us, 990.0),
            (of.p99_9_us, 999.0),
        ] {
            assert!((value / expected - 1.0).abs() < 1e-3, "{of:?}");
        }
        assert_eq!((of.count, of.max_us), (1_000, 1_000.0));
    }
}
