//! A histogram with bins of equal width on a logarithmic scale.

use serde::Serialize;

/// Bins per decade.
const PER_DECADE: i32 = 10;
/// Smaller values count as this: the resolution of a clock, µs.
const LEAST_US: f64 = 0.1;

/// One bin: `from_us <= value < to_us`.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct LogBin {
    /// Lower edge, µs.
    pub from_us: f64,
    /// Upper edge, µs.
    pub to_us: f64,
    /// Number of values.
    pub count: u64,
}

/// Counts values, each with its count, in ten bins a decade, from the first
/// occupied bin to the last. A value below 0.1 µs counts as 0.1 µs.
pub(super) fn log_histogram(counts: impl IntoIterator<Item = (f64, u64)>) -> Vec<LogBin> {
    let mut bins: Vec<LogBin> = Vec::new();
    let mut first = 0;
    for (value_us, count) in counts {
        // Ascending values have ascending bins.
        let number = bin_of(value_us);
        if bins.is_empty() {
            first = number;
        }
        let place = usize::try_from(number - first).unwrap_or(0);
        while bins.len() <= place {
            let number = first + bins.len() as i32;
            bins.push(LogBin {
                from_us: edge_us(number),
                to_us: edge_us(number + 1),
                count: 0,
            });
        }
        if let Some(bin) = bins.get_mut(place) {
            bin.count += count;
        }
    }
    bins
}

fn bin_of(value_us: f64) -> i32 {
    let number = (value_us.max(LEAST_US).log10() * f64::from(PER_DECADE)).floor() as i32;
    // Rounding may move the logarithm of an edge across it.
    if value_us >= edge_us(number + 1) {
        number + 1
    } else if value_us < edge_us(number) && value_us >= LEAST_US {
        number - 1
    } else {
        number
    }
}

fn edge_us(number: i32) -> f64 {
    10_f64.powf(f64::from(number) / f64::from(PER_DECADE))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Edges, calculated: 10^0.0, 10^0.1, ... = 1, 1.2589, 1.5849, 1.9953,
    /// 2.5119.
    #[test]
    fn values_are_counted_in_the_bins_they_lie_in() {
        let bins = log_histogram([(1.0, 2), (1.2, 1), (1.26, 1), (2.0, 5), (2.5, 1)]);
        let counts: Vec<_> = bins.iter().map(|bin| bin.count).collect();
        assert_eq!(counts, [3, 1, 0, 6]);
        for (bin, (from, to)) in bins.iter().zip([
            (1.0, 1.2589),
            (1.2589, 1.5849),
            (1.5849, 1.9953),
            (1.9953, 2.5119),
        ]) {
            assert!((bin.from_us - from).abs() < 1e-4, "{bin:?}");
            assert!((bin.to_us - to).abs() < 1e-4, "{bin:?}");
        }
    }

    #[test]
    fn decades_begin_bins_and_nothing_is_below_the_least() {
        let bins = log_histogram([(0.0, 4), (10.0, 1), (100.0, 1), (1_000.0, 1)]);
        assert_eq!(bins.first().unwrap().count, 4);
        assert!((bins.first().unwrap().from_us - 0.1).abs() < 1e-12);
        let filled = bins.iter().filter(|bin| bin.count > 0);
        let edges: Vec<_> = filled.map(|bin| bin.from_us.round()).collect();
        assert_eq!(edges, [0.0, 10.0, 100.0, 1_000.0]);
        assert!(log_histogram([]).is_empty());
    }
}
