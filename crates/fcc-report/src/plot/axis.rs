//! Axes: their ranges, ticks and labels.

use super::super::trace::Trace;

/// An axis: a range, ticks with their labels, and a title.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) ticks: Vec<(f64, String)>,
    /// Grid lines without labels.
    pub(crate) light: Vec<f64>,
    pub(crate) title: String,
}

/// Margin at either end, as a fraction of the span.
const MARGIN: f64 = 0.06;

impl Axis {
    /// From `low` to `high`, at least `least_span` long, with about `count`
    /// ticks.
    pub(crate) fn around(
        (low, high): (f64, f64),
        least_span: f64,
        count: usize,
        title: &str,
    ) -> Self {
        let middle = f64::midpoint(low, high);
        let span = (high - low).max(least_span);
        let reach = span * (0.5 + MARGIN);
        Self::exactly((middle - reach, middle + reach), count, title)
    }

    /// So many rows, without ticks.
    pub(crate) fn rows(count: usize) -> Self {
        Self {
            from: 0.0,
            to: count as f64,
            ticks: Vec::new(),
            light: Vec::new(),
            title: String::new(),
        }
    }

    /// From one value to another, with about `count` ticks.
    pub(crate) fn exactly((from, to): (f64, f64), count: usize, title: &str) -> Self {
        let step = nice_step((to - from) / count.max(1) as f64);
        // A scale needs at least two ticks.
        let finer = |step: &f64| Some(nice_step(0.4 * step));
        let step = std::iter::successors(Some(step), finer)
            .take(3)
            .find(|step| multiples(from, to, *step).count() >= 2)
            .unwrap_or(step);
        Self {
            ticks: ticks(from, to, step),
            light: Vec::new(),
            from,
            to,
            title: title.to_owned(),
        }
    }

    /// With a tick at every multiple of `step`, labelled by `label`.
    pub(crate) fn stepped(
        (from, to): (f64, f64),
        step: f64,
        title: &str,
        label: impl Fn(f64) -> String,
    ) -> Self {
        Self {
            ticks: multiples(from, to, step)
                .map(|at| (at, label(at)))
                .collect(),
            light: Vec::new(),
            from,
            to,
            title: title.to_owned(),
        }
    }

    /// A logarithmic axis over whole decades around positive values: its
    /// coordinate is the decimal logarithm.
    pub(crate) fn decades((low, high): (f64, f64), title: &str, label: fn(i32) -> String) -> Self {
        let from = low.max(f64::MIN_POSITIVE).log10().floor() as i32;
        let to = (high.max(f64::MIN_POSITIVE).log10().ceil() as i32).max(from + 1);
        Self {
            from: f64::from(from),
            to: f64::from(to),
            ticks: (from..=to).map(|d| (f64::from(d), label(d))).collect(),
            light: (from..to)
                .flat_map(|d| (2..10).map(move |n| f64::from(d) + f64::from(n).log10()))
                .collect(),
            title: title.to_owned(),
        }
    }
}

/// The lowest and highest value of lines; 0 and 0 if there is none.
pub(crate) fn extent<'a>(traces: impl IntoIterator<Item = &'a Trace>) -> (f64, f64) {
    traces
        .into_iter()
        .filter_map(Trace::extent)
        .reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
        .unwrap_or((0.0, 0.0))
}

/// 1, 2 or 5 times a power of ten, at least `least`.
fn nice_step(least: f64) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    let decade = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|n| n * decade)
        .find(|step| *step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

fn ticks(from: f64, to: f64, step: f64) -> Vec<(f64, String)> {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    multiples(from, to, step)
        .map(|at| (at, number(at, decimals)))
        .collect()
}

/// At most a hundred: an invalid range does not fill the page with ticks.
fn multiples(from: f64, to: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (from / step - 1e-9).ceil();
    // An hour less one tick counts as an hour.
    let last = (to / step + 2e-3).floor();
    let count = (last - first + 1.0).clamp(0.0, 100.0) as usize;
    (0..count).map(move |n| (first + n as f64) * step)
}

/// A number with a typographic minus.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks
            .iter()
            .map(|(_, labels)| labels.as_str())
            .collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        let axis = Axis::exactly((-0.3, 1.1), 6, "");
        assert_eq!(labels(&axis), ["0.0", "0.5", "1.0"]);
        let axis = Axis::exactly((-0.27, 0.36), 3, "");
        assert_eq!(labels(&axis), ["\u{2212}0.2", "0.0", "0.2"]);
        let axis = Axis::exactly((2_987.0, 3_162.0), 5, "");
        assert_eq!(labels(&axis), ["3000", "3050", "3100", "3150"]);
        assert_eq!(number(-0.001, 1), "0.0");
        assert_eq!(number(-12.34, 1), "\u{2212}12.3");
    }

    #[test]
    fn a_flat_line_has_an_axis_too() {
        let axis = Axis::around((100.0, 100.0), 4.0, 4, "");
        assert!(axis.from < 98.0 && axis.to > 102.0);
        assert!(axis.ticks.len() >= 3);
    }

    #[test]
    fn decades_cover_their_values() {
        let axis = Axis::decades((3.0, 450.0), "", |d| d.to_string());
        assert_eq!(labels(&axis), ["0", "1", "2", "3"]);
        assert_eq!(axis.light.len(), 24);
    }
}
