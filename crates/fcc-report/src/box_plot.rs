//! A box plot of values that were counted.

use serde::Serialize;

/// A box plot after J. Tukey, "Exploratory Data Analysis" (1977): the box is
/// the middle half, the whiskers end at the last value within 1.5 box lengths
/// of the box, and each value beyond them is a point.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct BoxPlot {
    /// Smallest value.
    pub min: f64,
    /// End of the lower whisker.
    pub whisker_low: f64,
    /// Lower quartile.
    pub q1: f64,
    /// Median.
    pub median: f64,
    /// Upper quartile.
    pub q3: f64,
    /// End of the upper whisker.
    pub whisker_high: f64,
    /// Largest value.
    pub max: f64,
    /// How many values lie beyond the whiskers.
    pub outlier_count: u64,
    /// The different values beyond the whiskers.
    #[serde(skip)]
    pub(crate) outliers: Vec<f64>,
}

/// Longest whisker, in box lengths.
const REACH: f64 = 1.5;

impl BoxPlot {
    /// `counts` holds values in ascending order and the count of each; `None`
    /// if it is empty.
    pub fn of(counts: &[(f64, u64)]) -> Option<Self> {
        let (min, max) = (counts.first()?.0, counts.last()?.0);
        let quartile = |share: f64| quantile(counts, share);
        let (q1, q3) = (quartile(0.25)?, quartile(0.75)?);
        let fences = (q1 - REACH * (q3 - q1))..=(q3 + REACH * (q3 - q1));
        let within = || counts.iter().filter(|(value, _)| fences.contains(value));
        let outside = || counts.iter().filter(|(value, _)| !fences.contains(value));
        Some(Self {
            min,
            // An interpolated quartile may have no value within reach.
            whisker_low: within().next().map_or(q1, |(value, _)| value.min(q1)),
            q1,
            median: quartile(0.5)?,
            q3,
            whisker_high: within().next_back().map_or(q3, |(value, _)| value.max(q3)),
            max,
            outlier_count: outside().map(|(_, count)| count).sum(),
            outliers: outside().map(|(value, _)| *value).collect(),
        })
    }

    /// The same box, less `nominal`, times `scale`.
    pub(crate) fn deviation_from(&self, nominal: f64, scale: f64) -> Self {
        let deviation = |value: f64| (value - nominal) * scale;
        Self {
            min: deviation(self.min),
            whisker_low: deviation(self.whisker_low),
            q1: deviation(self.q1),
            median: deviation(self.median),
            q3: deviation(self.q3),
            whisker_high: deviation(self.whisker_high),
            max: deviation(self.max),
            outlier_count: self.outlier_count,
            outliers: self.outliers.iter().map(|v| deviation(*v)).collect(),
        }
    }
}

/// Interpolates linearly between two values (Hyndman and Fan, 1996, type 7).
fn quantile(counts: &[(f64, u64)], share: f64) -> Option<f64> {
    let total: u64 = counts.iter().map(|(_, count)| count).sum();
    let place = share * total.checked_sub(1)? as f64;
    let ranked = |rank: u64| {
        let mut passed = 0;
        counts
            .iter()
            .find(|(_, count)| {
                passed += count;
                passed > rank
            })
            .map(|(value, _)| *value)
    };
    let (low, high) = (ranked(place.floor() as u64)?, ranked(place.ceil() as u64)?);
    Some(low + (high - low) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    // From numpy 2 and matplotlib 3:
    //
    //     x = [24.1, 24.8, 24.9, 24.95, 25.0, 25.0, 25.0, 25.02, 25.1, 25.2, 26.5, 27.0]
    //     np.percentile(x, [25, 50, 75])
    //     s = matplotlib.cbook.boxplot_stats(x)[0]; s["whislo"], s["whishi"], s["fliers"]
    #[test]
    fn quartiles_and_whiskers_are_those_of_numpy_and_matplotlib() {
        let counts = [
            (24.1, 1),
            (24.8, 1),
            (24.9, 1),
            (24.95, 1),
            (25.0, 3),
            (25.02, 1),
            (25.1, 1),
            (25.2, 1),
            (26.5, 1),
            (27.0, 1),
        ];
        let of = BoxPlot::of(&counts).unwrap();
        assert!((of.q1 - 24.9375).abs() < 1e-9, "{of:?}");
        assert!((of.median - 25.0).abs() < 1e-9);
        assert!((of.q3 - 25.125).abs() < 1e-9);
        assert_eq!((of.whisker_low, of.whisker_high), (24.8, 25.2));
        assert_eq!(of.outliers, [24.1, 26.5, 27.0]);
        assert_eq!(of.outlier_count, 3);
        assert_eq!((of.min, of.max), (24.1, 27.0));
    }

    #[test]
    fn one_value_is_a_box_of_no_length_and_none_is_no_box() {
        let one = BoxPlot::of(&[(25.0, 7)]).unwrap();
        assert_eq!((one.whisker_low, one.q1, one.q3), (25.0, 25.0, 25.0));
        assert_eq!(BoxPlot::of(&[]), None);
    }
}
