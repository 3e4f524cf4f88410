//! One line of a plot in bounded memory.
//!
//! The length of a recording is known only at its end. A trace therefore counts
//! time in bins, doubles their width whenever there are too many, and keeps the
//! first, lowest, highest and last point of each bin (U. Jugel et al., "M4: a
//! visualization-oriented time series data aggregation", 2014). Drawn no wider
//! than its number of bins, the line looks like one through every point.

/// At this many bins, pairs are merged.
const MOST_BINS: u64 = 16_384;
/// This many bins are more than the width of a plot in pixels.
pub(super) const OVERVIEW_BINS: u64 = 2_048;
/// The width of the first bins, s: less than the period of a fast loop.
const FINEST_S: f64 = 1.0 / 1_024.0;

/// A point of a line.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Point {
    /// Since the first tick.
    pub(super) time_s: f64,
    /// In the trace's unit.
    pub(super) value: f64,
}

/// A line that is being recorded.
#[derive(Clone, Debug)]
pub(super) struct Trace {
    width_s: f64,
    bins: Vec<Bin>,
    broken: bool,
}

#[derive(Clone, Copy, Debug)]
struct Bin {
    index: u64,
    /// Whether the line continues from the previous bin.
    joined: bool,
    first: Point,
    lowest: Point,
    highest: Point,
    last: Point,
}

impl Default for Trace {
    fn default() -> Self {
        Self {
            width_s: FINEST_S,
            bins: Vec::new(),
            broken: true,
        }
    }
}

impl Trace {
    /// Takes the value at a time; times ascend from 0. `None` interrupts the
    /// line.
    pub(super) fn push(&mut self, time_s: f64, value: Option<f64>) {
        let Some(value) = value.filter(|value| value.is_finite() && time_s >= 0.0) else {
            self.broken = true;
            return;
        };
        let point = Point { time_s, value };
        let mut index = self.index_of(time_s);
        while index >= MOST_BINS {
            self.coarsen();
            index = self.index_of(time_s);
        }
        let joined = !std::mem::take(&mut self.broken);
        let bin = Bin {
            index,
            joined,
            first: point,
            lowest: point,
            highest: point,
            last: point,
        };
        match self.bins.last_mut() {
            Some(last) if last.index >= index => last.take(&bin),
            _ => self.bins.push(bin),
        }
    }

    /// Interrupts the line: records are missing here.
    pub(super) fn cut(&mut self) {
        self.broken = true;
    }

    /// The same in fewer bins than `most`.
    pub(super) fn thinned(&self, most: u64) -> Self {
        let mut thinned = self.clone();
        while thinned.bins.last().is_some_and(|bin| bin.index >= most) {
            thinned.coarsen();
        }
        thinned
    }

    /// Number of values; for a long line, approximate.
    pub(super) const fn len(&self) -> usize {
        self.bins.len()
    }

    /// The uninterrupted lines, each in ascending time.
    pub(super) fn lines(&self) -> Vec<Vec<Point>> {
        let mut lines: Vec<Vec<Point>> = Vec::new();
        for bin in &self.bins {
            if !bin.joined || lines.is_empty() {
                lines.push(Vec::new());
            }
            if let Some(line) = lines.last_mut() {
                for point in bin.points() {
                    if line.last() != Some(&point) {
                        line.push(point);
                    }
                }
            }
        }
        lines
    }

    /// The last value; `None` if there is no value.
    pub(super) fn last(&self) -> Option<f64> {
        self.bins.last().map(|bin| bin.last.value)
    }

    /// The lowest and the highest value; `None` if there is no value.
    pub(super) fn extent(&self) -> Option<(f64, f64)> {
        self.bins
            .iter()
            .map(|bin| (bin.lowest.value, bin.highest.value))
            .reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
    }

    fn index_of(&self, time_s: f64) -> u64 {
        (time_s / self.width_s) as u64
    }

    fn coarsen(&mut self) {
        self.width_s *= 2.0;
        let mut coarse: Vec<Bin> = Vec::with_capacity(self.bins.len() / 2 + 1);
        for bin in self.bins.drain(..) {
            let bin = Bin {
                index: bin.index / 2,
                ..bin
            };
            match coarse.last_mut() {
                Some(last) if last.index == bin.index => last.take(&bin),
                _ => coarse.push(bin),
            }
        }
        self.bins = coarse;
    }
}

impl Bin {
    fn take(&mut self, later: &Self) {
        if later.lowest.value < self.lowest.value {
            self.lowest = later.lowest;
        }
        if later.highest.value > self.highest.value {
            self.highest = later.highest;
        }
        self.last = later.last;
    }

    /// In ascending time.
    fn points(&self) -> [Point; 4] {
        let (a, b) = if self.lowest.time_s <= self.highest.time_s {
            (self.lowest, self.highest)
        } else {
            (self.highest, self.lowest)
        };
        [self.first, a, b, self.last]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_line_is_kept_point_by_point() {
        let mut trace = Trace::default();
        for n in 0..40 {
            trace.push(f64::from(n) * 0.025, Some(f64::from(n % 7)));
        }
        let lines = trace.lines();
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].len(), 40);
        assert_eq!(lines[0][9].value, 2.0);
    }

    /// An hour at 100 Hz with one spike: the spike is kept, at its time.
    #[test]
    fn an_hour_takes_no_more_room_than_its_bins_and_keeps_its_spikes() {
        let mut trace = Trace::default();
        for n in 0..360_000 {
            let value = if n == 123_456 { 50.0 } else { f64::from(n % 3) };
            trace.push(f64::from(n) * 0.01, Some(value));
        }
        let lines = trace.lines();
        assert!(trace.bins.len() as u64 <= MOST_BINS);
        assert!(trace.bins.len() as u64 > MOST_BINS / 4);
        assert_eq!(trace.extent(), Some((0.0, 50.0)));
        let spike = lines[0].iter().find(|point| point.value == 50.0).unwrap();
        assert_eq!(spike.time_s, 1_234.56);
        assert!(lines[0].is_sorted_by_key(|point| point.time_s));
    }

    #[test]
    fn a_line_is_broken_where_there_is_no_value() {
        let mut trace = Trace::default();
        for (n, value) in [Some(1.0), Some(2.0), None, Some(f64::NAN), Some(3.0)]
            .into_iter()
            .enumerate()
        {
            trace.push(n as f64, value);
        }
        trace.cut();
        trace.push(9.0, Some(4.0));
        let lengths: Vec<_> = trace.lines().iter().map(Vec::len).collect();
        assert_eq!(lengths, [2, 1, 1]);
    }

    #[test]
    fn a_time_far_away_takes_no_memory() {
        let mut trace = Trace::default();
        trace.push(0.0, Some(1.0));
        trace.push(1e15, Some(2.0));
        trace.push(-1.0, Some(2.0));
        trace.push(f64::NAN, Some(2.0));
        assert_eq!(trace.lines().iter().map(Vec::len).sum::<usize>(), 2);
    }
}
