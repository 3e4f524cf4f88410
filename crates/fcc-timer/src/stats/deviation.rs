//! Deviations from a nominal value, on both sides.

use hdrhistogram::{CreationError, Histogram};

use super::FIGURES;

/// Signed deviations from a nominal value, ns.
///
/// A histogram of the values themselves would use its significant figures for
/// the known nominal part: five figures, and megabytes, to resolve 1 µs in 25 ms.
/// Three figures of the deviation resolve 10 ns in a jitter of 10 µs.
#[derive(Clone, Debug)]
pub(super) struct Deviations {
    below: Histogram<u32>,
    above: Histogram<u32>,
}

impl Deviations {
    /// For deviations from `-lowest` to `highest`; larger ones are clamped.
    pub(super) fn new(lowest: u64, highest: u64) -> Result<Self, CreationError> {
        Ok(Self {
            below: Histogram::new_with_bounds(1, lowest, FIGURES)?,
            above: Histogram::new_with_bounds(1, highest, FIGURES)?,
        })
    }

    pub(super) fn reset(&mut self) {
        self.below.reset();
        self.above.reset();
    }

    pub(super) fn record(&mut self, deviation: i64) {
        let side = if deviation < 0 {
            &mut self.below
        } else {
            &mut self.above
        };
        side.saturating_record(deviation.unsigned_abs());
    }

    /// How many counters it is made of.
    #[cfg(test)]
    pub(super) fn distinct_values(&self) -> usize {
        self.below.distinct_values() + self.above.distinct_values()
    }

    /// Every deviation with its count, lowest first. Values that the histograms do
    /// not distinguish are one value, the middle of their range.
    pub(super) fn counts(&self) -> impl Iterator<Item = (f64, u64)> {
        let below: Vec<_> = counts(&self.below).collect();
        below
            .into_iter()
            .rev()
            .map(|(distance, count)| (-distance, count))
            .chain(counts(&self.above))
    }

    /// The value in the middle, or the mean of the two in the middle. `None`
    /// when nothing was recorded.
    pub(super) fn median(&self) -> Option<f64> {
        let count = self.below.len() + self.above.len();
        let lower = self.ranked(count.div_ceil(2))?;
        let upper = self.ranked(count / 2 + 1)?;
        Some(f64::midpoint(lower, upper))
    }

    /// The `rank`-th smallest, the first being 1.
    fn ranked(&self, rank: u64) -> Option<f64> {
        let below = self.below.len();
        if rank <= below {
            // The smallest deviation is the largest of those below.
            nth(&self.below, below - rank + 1).map(|distance| -distance)
        } else {
            nth(&self.above, rank - below)
        }
    }
}

/// Every value recorded, as the middle of the range that the histogram cannot
/// tell apart, with how often, lowest first.
pub(super) fn counts(histogram: &Histogram<u32>) -> impl Iterator<Item = (f64, u64)> {
    histogram.iter_recorded().map(|step| {
        let value = step.value_iterated_to();
        (
            f64::midpoint(
                histogram.lowest_equivalent(value) as f64,
                histogram.highest_equivalent(value) as f64,
            ),
            u64::from(step.count_at_value()),
        )
    })
}

/// The `rank`-th smallest value recorded, the first being 1, as the middle of
/// the range that the histogram cannot tell apart.
fn nth(histogram: &Histogram<u32>, rank: u64) -> Option<f64> {
    let mut passed = 0;
    counts(histogram)
        .find(|(_, count)| {
            passed += count;
            passed >= rank
        })
        .map(|(value, _)| value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[i64]) -> Deviations {
        let mut deviations = Deviations::new(25_000_000, 1_000_000_000).unwrap();
        for value in values {
            deviations.record(*value);
        }
        deviations
    }

    // Medians as numpy.median gives them.
    #[test]
    fn the_median_is_found_on_either_side_and_across() {
        assert_eq!(of(&[]).median(), None);
        assert_eq!(of(&[7]).median(), Some(7.0));
        assert_eq!(of(&[-9, -3, 0]).median(), Some(-3.0));
        assert_eq!(of(&[-9, -3, 0, 4, 1000]).median(), Some(0.0));
        assert_eq!(of(&[-4, 2]).median(), Some(-1.0));
        assert_eq!(of(&[-200, -100, 50, 60]).median(), Some(-25.0));
    }

    #[test]
    fn values_beyond_the_histogram_count_as_its_last() {
        let median = of(&[i64::MAX; 3]).median().unwrap();
        assert!((median / 1e9 - 1.0).abs() < 1e-3, "{median}");
    }
}
