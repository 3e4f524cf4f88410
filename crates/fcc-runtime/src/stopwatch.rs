//! Measures the duration of each stage of a tick.

use fcc_timer::Timer;

/// Measures one stage after the other. Its readings are stored in the record, and
/// decisions use the values in the record (see [`overruns`](crate::overruns)).
pub(crate) struct Stopwatch {
    lap_ns: i64,
}

impl Stopwatch {
    pub(crate) fn start(timer: &dyn Timer) -> Self {
        Self {
            lap_ns: timer.now_ns(),
        }
    }

    /// Time since the start or the last lap.
    pub(crate) fn lap(&mut self, timer: &dyn Timer) -> u64 {
        let now_ns = timer.now_ns();
        let lap = span_ns(self.lap_ns, now_ns);
        self.lap_ns = now_ns;
        lap
    }

    /// Time from `from_ns` to the last lap.
    pub(crate) fn since(&self, from_ns: i64) -> u64 {
        span_ns(from_ns, self.lap_ns)
    }
}

fn span_ns(from_ns: i64, to_ns: i64) -> u64 {
    u64::try_from(to_ns.saturating_sub(from_ns)).unwrap_or(0)
}
