//! Timing of the loop, in a form that other tools read.

use std::fmt;

use fcc_core::framework::Record;
use fcc_timer::realtime::LatencyLimit;
use fcc_timer::{Expiry, RealtimeGranted, TimingSummary};
use serde::Serialize;

/// The deadline that a tick served, from its record: for statistics outside of the
/// loop. What only the timer knows, such as the time that it spun, is 0.
pub fn expiry_of<M, E, S, O>(record: &Record<M, E, S, O>) -> Expiry {
    let tick = &record.tick;
    Expiry {
        number: tick.number,
        scheduled_ns: tick.scheduled.as_nanos(),
        woke_ns: tick.woke.as_nanos(),
        missed: tick.missed,
        early_wake_ns: record.early_wake_ns,
        ..Expiry::default()
    }
}

/// Timing of the loop.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TimingReport {
    /// Nominal rate.
    pub rate_hz: f64,
    /// Which timer: `timerfd`, `posix`, `nanosleep`.
    pub timer: String,
    /// Ticks completed.
    pub ticks: u64,
    /// Missed periods.
    pub missed: u64,
    /// First tick to last, as text for comparison with the thesis.
    #[serde(skip)]
    pub runtime_s: f64,
    /// Time between wake-ups.
    pub period_ms: Period,
    /// Time from deadline to wake-up.
    pub lateness_us: Lateness,
    /// What the kernel granted the loop's thread.
    pub realtime: Realtime,
    /// CPU time of the loop's thread over the runtime, if measured.
    pub cpu_percent: Option<f64>,
    /// Page faults of the loop's thread while it ran, if counted.
    pub page_faults: Option<u64>,
    /// How early the timer woke; none if it did not wake early.
    pub early_wake: Option<EarlyWake>,
}

impl TimingReport {
    /// From the statistics of a loop.
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

    /// Adds the time that the loop's thread spun until its deadlines, s.
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

/// How long before its deadlines the timer woke.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct EarlyWake {
    /// In the last tick.
    pub last_us: f64,
    /// At most.
    pub max_us: f64,
    /// Share of a core spent spinning, if measured.
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
    /// Largest minus smallest.
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
    /// `SCHED_FIFO` or `SCHED_OTHER`; empty if not known.
    pub policy: String,
    /// 0 for `SCHED_OTHER`.
    pub priority: i32,
    /// The CPU that the thread is bound to; none if it may run on several.
    pub cpu: Option<usize>,
    /// Why this CPU was chosen, or why none, if one was requested.
    pub cpu_because: String,
    /// Whether the process' memory is locked.
    pub memory_locked: bool,
    /// Whether the stack was in memory before the first tick.
    pub stack_prefaulted: bool,
    /// Timer slack of the thread, if known.
    pub timer_slack_ns: Option<u64>,
    /// Longest wake-up latency of the CPUs, if a limit was granted.
    pub cpu_dma_latency_us: Option<u32>,
    /// Requests that were denied.
    pub refused: Vec<Denial>,
}

impl From<&RealtimeGranted> for Realtime {
    fn from(granted: &RealtimeGranted) -> Self {
        let denied = granted.denied.iter().map(|denied| Denial {
            request: denied.request.clone(),
            reason: denied.reason.clone(),
            remedy: denied.remedy.clone(),
        });
        Self {
            policy: granted.policy.to_owned(),
            priority: granted.priority,
            cpu: granted.cpu,
            cpu_because: granted.cpu_reason.clone(),
            memory_locked: granted.memory_locked,
            stack_prefaulted: granted.stack_prefaulted,
            timer_slack_ns: granted.timer_slack_ns,
            cpu_dma_latency_us: granted.cpu_latency.as_ref().map(LatencyLimit::us),
            refused: denied.collect(),
        }
    }
}

/// A denied request, as it is recorded and reported.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize)]
pub struct Denial {
    /// What was requested.
    pub request: String,
    /// Why it was denied.
    pub reason: String,
    /// What would help.
    pub remedy: String,
}

impl fmt::Display for Denial {
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

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Record, State, Tick, Time};

    use super::*;

    #[test]
    fn the_deadline_of_a_record_is_that_of_its_tick() {
        let tick = Tick {
            number: 7,
            scheduled: Time::from_nanos(175_000_000),
            woke: Time::from_nanos(175_040_000),
            missed: 2,
            dt_s: 0.075,
        };
        let record = Record::<f64, f64, f64, f64> {
            early_wake_ns: 30_000,
            ..Record::new(tick, State::Standby)
        };
        let expiry = expiry_of(&record);
        assert_eq!(expiry.lateness_ns(), 40_000);
        assert_eq!((expiry.number, expiry.missed), (7, 2));
        assert_eq!(expiry.early_wake_ns, 30_000);
    }
}
