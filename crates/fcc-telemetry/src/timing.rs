//! How well the loop kept time, as other tools read it.

use serde::Serialize;

/// How well the loop kept time.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TimingReport {
    /// Nominal.
    pub rate_hz: f64,
    /// Which timer: `timerfd`, `posix`, `nanosleep`.
    pub timer: &'static str,
    /// Ticks served.
    pub ticks: u64,
    /// Periods that passed unserved.
    pub missed: u64,
    /// First tick to last; for people, who compare it with the thesis'.
    #[serde(skip)]
    pub runtime_s: f64,
    /// Time between wake-ups.
    pub period_ms: Period,
    /// Time from deadline to wake-up.
    pub lateness_us: Lateness,
    /// What the kernel granted the loop's thread.
    pub realtime: Realtime,
    /// CPU time of the loop's thread over the runtime.
    pub cpu_percent: f64,
}

/// Time between wake-ups, ms.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Period {
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
    /// Largest less smallest.
    pub range: f64,
    /// Share of periods within ±2 % of nominal, 0..=1.
    pub within_2_percent: f64,
}

/// Time from deadline to wake-up, µs.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Lateness {
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// 99.9th percentile.
    pub p99_9: f64,
    /// Largest.
    pub max: f64,
}

/// What the kernel granted the loop's thread.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Realtime {
    /// `SCHED_FIFO` or `SCHED_OTHER`.
    pub policy: &'static str,
    /// 0 for `SCHED_OTHER`.
    pub priority: i32,
    /// Whether the process' memory is locked.
    pub memory_locked: bool,
    /// Wishes that were not granted.
    pub refused: Vec<RefusedWish>,
}

/// A wish that was not granted.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct RefusedWish {
    /// What was asked for.
    pub wish: String,
    /// Why it was refused.
    pub reason: String,
    /// What would help.
    pub remedy: String,
}
