//! The outcome of a flight, for users and tools.

use fcc_guidance::{Mode, Progress};
use fcc_runtime::{Ending, LoopReport};
use fcc_telemetry::{FlightScore, Realtime, ScoredBy, TimingReport};
use fcc_timer::RealtimeGranted;
use serde::Serialize;

use super::ground::Impact;
use super::plan::Pace;

/// The scheduling of a loop without a thread of its own.
const NOT_ASKED: &str = "not asked for";

/// The outcome of a flight.
#[derive(Debug, Serialize)]
pub struct Outcome {
    /// The timing of the loop.
    pub timing: TimingReport,
    /// The score of the pattern; none without a pattern.
    pub flight: Option<FlightScore>,
    /// Why a pattern has no score.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_scored: Option<String>,
    /// What matters for a vehicle that is no aeroplane.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<Figure>,
    /// The basis of the score.
    pub scored_by: ScoredBy,
    /// The events, in order.
    pub events: Vec<EventEntry>,
    /// Why the loop ended.
    pub ending: String,
    /// Where and how a simulated aircraft hit the ground; none if it did not.
    pub impact: Option<Impact>,
    /// How often it entered failsafe.
    pub failsafes: u64,
    /// Ticks that overran their budget.
    pub overruns: u64,
    /// Ticks that left no time to sleep before the next.
    pub unslept: u64,
    /// Whether control was released.
    pub released: bool,
    /// Records that were not read in time.
    pub records_dropped: u64,
    /// What was recorded of the flight; none if it was not recorded.
    pub recording: Option<RecordingOutcome>,
    /// The pace of time.
    #[serde(skip)]
    pub pace: Pace,
    /// Whether a signal ended it.
    #[serde(skip)]
    pub interrupted: bool,
    /// The conclusion for the user.
    #[serde(skip)]
    pub conclusion: Conclusion,
}

/// A figure of a flight.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Figure {
    /// What it is.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
}

/// The conclusion of a flight for the user; of several the worst.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Conclusion {
    /// It was flown as planned.
    Completed,
    /// It was flown as planned, but not recorded, or not completely.
    NotRecorded,
    /// It was not flown as planned: the timer failed, engaging was refused, or
    /// control had to be given back at once and that ends the program.
    Failed,
    /// The plan was not flown to its end.
    NotFlown,
    /// It entered failsafe.
    Failsafe,
    /// The simulated aircraft hit the ground.
    HitGround,
    /// A component of the loop panicked; the controls were released.
    Panicked,
    /// The loop hung; its watchdog released the controls.
    Hung,
    /// For too long the loop's ticks left no time to sleep; it stopped.
    Overloaded,
    /// The controls may still be held.
    NotReleased,
}

/// Why a flight is over.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Over {
    /// Its time has passed.
    Time,
    /// Its plan is flown to its end.
    Flown,
    /// Its take-off was given up, and it stands.
    GivenUp,
    /// The wheels touched the ground where they are not to.
    Ground,
    /// The loop entered failsafe.
    Failsafe,
    /// Engaging was refused.
    Refused,
}

/// An event.
#[derive(Clone, Debug, Serialize)]
pub struct EventEntry {
    /// Since the loop's first tick.
    pub time_s: f64,
    /// Its tick.
    pub tick: u64,
    /// Its description.
    pub text: String,
}

/// What was recorded of a flight.
#[derive(Clone, Debug, Serialize)]
pub struct RecordingOutcome {
    /// Every file of the recording, in order, that was not lost since.
    pub files: Vec<String>,
    /// Records written.
    pub ticks: u64,
    /// Bytes written.
    pub bytes: u64,
    /// Records and events that were dropped: the disk was too slow or full.
    pub not_recorded: u64,
    /// Why the flight's end is not recorded, and what is lost; none if it is
    /// recorded.
    pub stopped: Option<String>,
}

impl Outcome {
    pub(crate) fn new(timer: &'static str, pace: Pace, report: &LoopReport) -> Self {
        let conclusion = match report.ending {
            _ if !report.released => Conclusion::NotReleased,
            Ending::Panicked(_) => Conclusion::Panicked,
            Ending::Hung => Conclusion::Hung,
            Ending::Overloaded => Conclusion::Overloaded,
            Ending::TimerFailed(_) | Ending::ReleasedAtOnce => Conclusion::Failed,
            _ if report.failsafes > 0 => Conclusion::Failsafe,
            _ => Conclusion::Completed,
        };
        Self {
            timing: TimingReport {
                page_faults: report.page_faults,
                ..TimingReport::new(timer, &report.timing, realtime(report.granted.as_ref()))
            }
            .with_cpu_time(report.cpu_time.as_secs_f64())
            .with_spin_time(report.timing.spun_s),
            flight: None,
            not_scored: None,
            figures: Vec::new(),
            scored_by: ScoredBy::Measurement,
            events: Vec::new(),
            ending: report.ending.to_string(),
            impact: None,
            failsafes: report.failsafes,
            overruns: report.overruns,
            unslept: report.unslept,
            released: report.released,
            records_dropped: report.records_dropped,
            recording: None,
            pace,
            interrupted: false,
            conclusion,
        }
    }

    /// A requested recording is missing or incomplete: that does not end a
    /// flight, but is reported in its conclusion.
    pub(super) fn was_not_recorded(&mut self) {
        if self.conclusion == Conclusion::Completed {
            self.conclusion = Conclusion::NotRecorded;
        }
    }

    /// The flight ended on the ground: the loop was stopped.
    pub(crate) fn hit_ground(&mut self, impact: Impact) {
        if matches!(
            self.conclusion,
            Conclusion::Completed | Conclusion::Failed | Conclusion::Failsafe
        ) {
            self.conclusion = Conclusion::HitGround;
        }
        self.ending = impact.to_string();
        self.impact = Some(impact);
    }

    /// The plan is not flown to its end: what was flown, and why.
    pub(super) fn was_not_flown(&mut self, flown: Progress, given_up: Option<&str>, over: Over) {
        if self.conclusion == Conclusion::Completed {
            self.conclusion = Conclusion::NotFlown;
        }
        let flown = match (flown.mode, flown.item) {
            (Mode::None, _) => "it was not engaged".to_owned(),
            (mode, 0) => format!("the mode {mode} was flown"),
            (mode, item) => format!("item {item} was flown, in the mode {mode}"),
        };
        let why = match given_up {
            Some(why) => format!("; {why}"),
            None => {
                ": give it more time (--seconds), a shorter plan, or a command if it is for ever"
                    .to_owned()
            }
        };
        let what = match over {
            Over::Time => "the time to fly is over, and the plan is not flown to its end",
            _ => "the plan is not flown to its end",
        };
        self.ending = format!("{what}: {flown}{why}");
    }

    /// Says who stopped a loop that was stopped from outside.
    /// `refusal` is why engaging was refused last, if it was.
    pub(super) fn explain(
        &mut self,
        interrupted_by: Option<&str>,
        over: Option<Over>,
        refusal: Option<&str>,
    ) {
        self.interrupted = interrupted_by.is_some();
        self.ending = match (interrupted_by, over) {
            (Some(by), _) => format!("interrupted by {by}"),
            (None, Some(Over::Time)) => "the time to fly is over".to_owned(),
            (None, Some(Over::GivenUp)) => "the take-off was given up".to_owned(),
            (None, Some(Over::Flown)) => "the plan is flown to its end".to_owned(),
            (None, Some(Over::Ground)) => {
                if matches!(self.conclusion, Conclusion::Completed | Conclusion::Failed) {
                    self.conclusion = Conclusion::HitGround;
                }
                "the wheels touched the ground outside of a take-off or a landing".to_owned()
            }
            (None, Some(Over::Failsafe)) => {
                "it entered failsafe, which ends a flight of a given length".to_owned()
            }
            (None, Some(Over::Refused)) => {
                if self.conclusion == Conclusion::Completed {
                    self.conclusion = Conclusion::NotFlown;
                }
                refusal.unwrap_or("engaging was refused").to_owned()
            }
            (None, None) => return,
        };
    }
}

/// What the kernel granted; nothing was requested for a loop without a thread of
/// its own.
fn realtime(granted: Option<&RealtimeGranted>) -> Realtime {
    granted.map_or_else(
        || Realtime {
            policy: NOT_ASKED.to_owned(),
            ..Realtime::default()
        },
        Realtime::from,
    )
}
