//! The profile of a value over a recording of unknown length, as one line of
//! text.

/// Most columns of a line: a row of the table has 80.
const COLUMNS: usize = 16;

/// Eighths of a cell, none to full.
const BARS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// The largest value in each of up to 16 equal spans of ticks. When the
/// recording exceeds them, pairs of spans are merged.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    /// Ticks in one span.
    span: u64,
    ticks: u64,
    largest: Vec<f64>,
}

impl Default for Profile {
    fn default() -> Self {
        Self {
            span: 1,
            ticks: 0,
            largest: Vec::with_capacity(COLUMNS),
        }
    }
}

impl Profile {
    /// Takes the next tick's value, 0 or more.
    pub(super) fn push(&mut self, value: f64) {
        if self.ticks.is_multiple_of(self.span) {
            if self.largest.len() == COLUMNS {
                self.merge();
            }
            // After merging, the tick may still belong to the last span.
            if self.ticks.is_multiple_of(self.span) {
                self.largest.push(0.0);
            }
        }
        if let Some(last) = self.largest.last_mut() {
            *last = last.max(value);
        }
        self.ticks += 1;
    }

    fn merge(&mut self) {
        self.largest = self
            .largest
            .chunks(2)
            .map(|pair| pair.iter().copied().fold(0.0, f64::max))
            .collect();
        self.largest.reserve(COLUMNS);
        self.span *= 2;
    }

    /// One character per span, the tallest for the largest value.
    pub(super) fn line(&self) -> String {
        let most = self.largest.iter().copied().fold(0.0, f64::max);
        let full = (BARS.len() - 1) as f64;
        let bar = |value: &f64| {
            // A value above 0 is always visible.
            let eighths = if most > 0.0 {
                (value / most * full).ceil() as usize
            } else {
                0
            };
            BARS.get(eighths).copied().unwrap_or('█')
        };
        self.largest.iter().map(bar).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_is_where_it_was_however_long_the_flight() {
        for ticks in [16_u64, 100, 1_000, 123_456] {
            let mut profile = Profile::default();
            for tick in 0..ticks {
                profile.push(if tick == ticks / 2 { 8.0 } else { 1.0 });
            }
            let line: Vec<char> = profile.line().chars().collect();
            assert!((8..=16).contains(&line.len()), "{ticks}: {}", line.len());
            let peaks: Vec<_> = (0..line.len()).filter(|n| line[*n] == '█').collect();
            assert_eq!(peaks.len(), 1);
            // At half of the ticks, within a span; the spans may extend beyond
            // the end.
            let place = (peaks[0] as f64 + 0.5) * profile.span as f64 / ticks as f64;
            assert!((place - 0.5).abs() <= 0.5 / 8.0 + 0.01, "{ticks}: {place}");
            assert!(line.iter().all(|c| *c == '█' || *c == '▁'));
        }
    }

    #[test]
    fn nothing_is_an_empty_line() {
        let mut profile = Profile::default();
        assert_eq!(profile.line(), "");
        profile.push(0.0);
        assert_eq!(profile.line(), " ");
    }
}
