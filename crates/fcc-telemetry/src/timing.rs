//! How well the loop kept time, as other tools read it.

use std::fmt;

use fcc_timer::TimingSummary;
use serde::Serialize;

/// How well the loop kept time.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TimingReport {
    /// Nominal.
    pub rate_hz: f64,
    /// Which timer: `timerfd`, `posix`, `nanosleep`.
    pub timer: String,
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
    /// CPU time of the loop's thread over the runtime; none where nobody
    /// measured it.
    pub cpu_percent: Option<f64>,
    /// Page faults of the loop's thread while it ran; none where nobody
    /// counted them.
    pub page_faults: Option<u64>,
    /// How early the timer woke; none where it did not wake early.
    pub early_wake: Option<EarlyWake>,
}

impl TimingReport {
    /// What a loop's statistics say of it.
    pub fn new(timer: &str, summary: &TimingSummary, realtime: Realtime) -> Self {
        Self {
            rate_hz: summary.rate_hz,
            timer: timer.to_owned(),
            ticks: summary.ticks,
            missed: summary.missed,
            runtime_s: summary.runtime_s,
            period_ms: Period {
                mean: summary.period_mean_ms,
                median: summary.period_median_ms,
                min: summary.period_min_ms,
                max: summary.period_max_ms,
                range: summary.period_range_ms,
                within_2_percent: summary.period_within_2_percent,
            },
            lateness_us: Lateness {
                p50: summary.lateness_p50_us,
                p99: summary.lateness_p99_us,
                p99_9: summary.lateness_p99_9_us,
                max: summary.lateness_max_us,
            },
            realtime,
            cpu_percent: None,
            page_faults: None,
            early_wake: (summary.early_wake_max_us > 0.0).then_some(EarlyWake {
                last_us: summary.early_wake_us,
                max_us: summary.early_wake_max_us,
                spin_percent: None,
            }),
        }
    }

    /// Adds the CPU time that the loop's thread took, s.
    #[must_use]
    pub fn with_cpu_time(mut self, cpu_s: f64) -> Self {
        self.cpu_percent = Some(self.percent_of_runtime(cpu_s));
        self
    }

    /// Adds the time that the loop's thread spun towards its deadlines, s.
    #[must_use]
    pub fn with_spin_time(mut self, spun_s: f64) -> Self {
        let percent = self.percent_of_runtime(spun_s);
        if let Some(early_wake) = &mut self.early_wake {
            early_wake.spin_percent = Some(percent);
        }
        self
    }

    fn percent_of_runtime(&self, time_s: f64) -> f64 {
        if self.runtime_s > 0.0 {
            100.0 * time_s / self.runtime_s
        } else {
            0.0
        }
    }
}

/// How long before its deadlines a timer woke.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct EarlyWake {
    /// In the last tick.
    pub last_us: f64,
    /// At most.
    pub max_us: f64,
    /// Share of a core that was spent spinning; none where nobody measured it.
    pub spin_percent: Option<f64>,
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
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct Realtime {
    /// `SCHED_FIFO` or `SCHED_OTHER`; empty if nobody knows.
    pub policy: String,
    /// 0 for `SCHED_OTHER`.
    pub priority: i32,
    /// The CPU that the thread is bound to; none if it may run on several.
    pub cpu: Option<usize>,
    /// Why this CPU, or why none, if one was asked for.
    pub cpu_because: String,
    /// Whether the process' memory is locked.
    pub memory_locked: bool,
    /// Whether the stack was in memory before the first tick.
    pub stack_prefaulted: bool,
    /// How late the kernel may make a sleep of the thread, if known.
    pub timer_slack_ns: Option<u64>,
    /// How long CPUs may take to wake, if that was granted.
    pub cpu_dma_latency_us: Option<u32>,
    /// Wishes that were not granted.
    pub refused: Vec<DeniedRequest>,
}

/// A wish that was not granted.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize)]
pub struct DeniedRequest {
    /// What was asked for.
    pub request: String,
    /// Why it was refused.
    pub reason: String,
    /// What would help.
    pub remedy: String,
}

impl fmt::Display for DeniedRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.request)?;
        if !self.reason.is_empty() {
            write!(f, " ({})", self.reason)?;
        }
        if !self.remedy.is_empty() {
            write!(f, ": {}", self.remedy)?;
        }
        Ok(())
    }
}
