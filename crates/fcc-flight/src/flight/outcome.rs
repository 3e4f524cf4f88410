//! How a flight ended, for people and for tools.

use fcc_runtime::{Ending, LoopReport};
use fcc_telemetry::{DeniedRequest, FlightScore, Realtime, ScoredBy, TimingReport};
use fcc_timer::RealtimeGranted;
use fcc_timer::realtime::LatencyLimit;
use serde::Serialize;

use super::plan::Pace;

/// The scheduling of a loop without a thread of its own.
const NOT_ASKED: &str = "not asked for";

/// How a flight ended.
#[derive(Debug, Serialize)]
pub struct Outcome {
    /// How well the loop kept time.
    pub timing: TimingReport,
    /// How well the pattern was flown; none without a pattern.
    pub flight: Option<FlightScore>,
    /// What that was scored by.
    pub scored_by: ScoredBy,
    /// What happened, in order.
    pub events: Vec<EventEntry>,
    /// Why the loop ended.
    pub ending: String,
    /// How often it fell into failsafe.
    pub failsafes: u64,
    /// Ticks that overran their budget.
    pub overruns: u64,
    /// Whether control was given back.
    pub released: bool,
    /// Records that nobody fetched in time.
    pub records_dropped: u64,
    /// What of the flight got onto the disk; none if it was not recorded.
    pub recording: Option<RecordingOutcome>,
    /// How fast time passed.
    #[serde(skip)]
    pub pace: Pace,
    /// Whether a signal ended it.
    #[serde(skip)]
    pub interrupted: bool,
    /// What it means for whoever flew it.
    #[serde(skip)]
    pub conclusion: Conclusion,
}

/// What a flight's end means for whoever flew it; of several the worst.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Conclusion {
    /// It was flown as it should.
    Completed,
    /// It was flown as it should, but not recorded, or not as a whole.
    NotRecorded,
    /// It was not flown as it should: the timer failed, or engaging was refused.
    Failed,
    /// It fell into failsafe.
    Failsafe,
    /// A part of the loop panicked; the controls were released.
    Panicked,
    /// The loop hung; its watchdog released the controls.
    Hung,
    /// The controls may still be held.
    NotReleased,
}

/// Something that happened once.
#[derive(Clone, Debug, Serialize)]
pub struct EventEntry {
    /// Since the loop's first tick.
    pub time_s: f64,
    /// In which tick.
    pub tick: u64,
    /// What it was, in words.
    pub text: String,
}

/// What of a flight got onto the disk.
#[derive(Clone, Debug, Serialize)]
pub struct RecordingOutcome {
    /// Every file of the recording, in order.
    pub files: Vec<String>,
    /// Records written.
    pub ticks: u64,
    /// Bytes written.
    pub bytes: u64,
    /// Records and events that were dropped: the disk was too slow or full.
    pub not_recorded: u64,
    /// Why the flight's end is not recorded, and what of it is lost; none if it
    /// is.
    pub stopped: Option<String>,
}

impl Outcome {
    pub(super) fn new(timer: &'static str, pace: Pace, report: LoopReport) -> Self {
        let conclusion = match report.ending {
            _ if !report.released => Conclusion::NotReleased,
            Ending::Panicked(_) => Conclusion::Panicked,
            Ending::Hung => Conclusion::Hung,
            Ending::TimerFailed(_) => Conclusion::Failed,
            _ if report.failsafes > 0 => Conclusion::Failsafe,
            _ => Conclusion::Completed,
        };
        Self {
            timing: TimingReport {
                page_faults: report.page_faults,
                ..TimingReport::new(
                    timer,
                    &report.timing,
                    realtime(&report.granted.unwrap_or_default()),
                )
            }
            .with_cpu_time(report.cpu_time.as_secs_f64())
            .with_spin_time(report.timing.spun_s),
            flight: None,
            scored_by: ScoredBy::Measurement,
            events: Vec::new(),
            ending: report.ending.to_string(),
            failsafes: report.failsafes,
            overruns: report.overruns,
            released: report.released,
            records_dropped: report.records_dropped,
            recording: None,
            pace,
            interrupted: false,
            conclusion,
        }
    }

    /// What was to be recorded is not, or not as a whole: that does not end a
    /// flight, but its end says so.
    pub(super) fn was_not_recorded(&mut self) {
        if self.conclusion == Conclusion::Completed {
            self.conclusion = Conclusion::NotRecorded;
        }
    }

    /// Says more exactly why a flight ended than the loop can.
    pub(super) fn explain(&mut self, interrupted: bool, refused: bool) {
        self.interrupted = interrupted;
        if interrupted {
            "interrupted by a signal".clone_into(&mut self.ending);
        } else if refused {
            "engaging was refused; the last event says why".clone_into(&mut self.ending);
            if matches!(
                self.conclusion,
                Conclusion::Completed | Conclusion::NotRecorded
            ) {
                self.conclusion = Conclusion::Failed;
            }
        }
    }
}

/// What the kernel granted, as other tools read it.
fn realtime(granted: &RealtimeGranted) -> Realtime {
    Realtime {
        policy: if granted.policy.is_empty() {
            NOT_ASKED
        } else {
            granted.policy
        }
        .to_owned(),
        priority: granted.priority,
        cpu: granted.cpu,
        cpu_because: granted.cpu_reason.clone(),
        memory_locked: granted.memory_locked,
        stack_prefaulted: granted.stack_prefaulted,
        timer_slack_ns: granted.timer_slack_ns,
        cpu_dma_latency_us: granted.cpu_latency.as_ref().map(LatencyLimit::us),
        refused: granted
            .denied
            .iter()
            .map(|denied| DeniedRequest {
                request: denied.request.clone(),
                reason: denied.reason.clone(),
                remedy: denied.remedy.clone(),
            })
            .collect(),
    }
}
