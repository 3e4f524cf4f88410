//! Counts lateness.

use fcc_core::framework::Tick;
use hdrhistogram::Histogram;

/// Upper bounds of the bins of [`LatenessCounts`], ns: half decades from 100 ns
/// on. One more bin counts what is above.
pub const LATENESS_BOUNDS_NS: [u64; 13] = [
    100,
    316,
    1_000,
    3_162,
    10_000,
    31_623,
    100_000,
    316_228,
    1_000_000,
    3_162_278,
    10_000_000,
    31_622_777,
    100_000_000,
];

/// Ticks by lateness: bin `n` counts those above bound `n - 1` and up to bound
/// `n` of [`LATENESS_BOUNDS_NS`].
pub type LatenessCounts = [u64; LATENESS_BOUNDS_NS.len() + 1];

/// Lateness since the start of the loop.
#[derive(Debug)]
pub(super) struct Lateness {
    quantiles: Option<Histogram<u64>>,
    pub(super) counts: LatenessCounts,
    pub(super) ticks: u64,
    pub(super) missed: u64,
    pub(super) max_ns: u64,
}

impl Lateness {
    pub(super) fn new() -> Self {
        Self {
            // Three significant digits up to a minute; fixed bounds cannot
            // fail.
            quantiles: Histogram::new_with_bounds(1, 60_000_000_000, 3).ok(),
            counts: LatenessCounts::default(),
            ticks: 0,
            missed: 0,
            max_ns: 0,
        }
    }

    pub(super) fn take(&mut self, tick: &Tick) {
        let late_ns = u64::try_from(tick.lateness().as_nanos()).unwrap_or(u64::MAX);
        self.ticks += 1;
        self.missed += tick.missed;
        self.max_ns = self.max_ns.max(late_ns);
        if let Some(quantiles) = &mut self.quantiles {
            quantiles.saturating_record(late_ns);
        }
        let bin = LATENESS_BOUNDS_NS.partition_point(|bound| *bound < late_ns);
        if let Some(count) = self.counts.get_mut(bin) {
            *count += 1;
        }
    }

    /// The lateness that this share of the ticks did not exceed, ns.
    pub(super) fn quantile_ns(&self, share: f64) -> u64 {
        self.quantiles.as_ref().map_or(0, |quantiles| {
            quantiles.value_at_quantile(share).min(self.max_ns)
        })
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::Time;

    use super::*;

    #[test]
    fn counts_and_quantiles_are_those_of_a_known_series() {
        let mut lateness = Lateness::new();
        // 1 µs, 2 µs, ... 1000 µs: the quantiles are known, and so is how many
        // lie in each half decade.
        for late_us in 1..=1_000 {
            lateness.take(&Tick {
                scheduled: Time::from_nanos(0),
                woke: Time::from_nanos(late_us * 1_000),
                missed: 1,
                ..Tick::default()
            });
        }
        assert_eq!(
            lateness.counts,
            [0, 0, 1, 2, 7, 21, 69, 216, 684, 0, 0, 0, 0, 0]
        );
        assert_eq!((lateness.ticks, lateness.missed), (1_000, 1_000));
        assert_eq!(lateness.max_ns, 1_000_000);
        for (share, expected_ns) in [(0.5, 500e3), (0.99, 990e3), (0.999, 999e3)] {
            let off = lateness.quantile_ns(share) as f64 / expected_ns - 1.0;
            assert!(off.abs() < 1e-3, "{share}: {off}");
        }
    }
}
