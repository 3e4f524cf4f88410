//! What a report says.

use std::ops::Deref;

use fcc_record::Damage;
use fcc_telemetry::TimingReport;
use serde::Serialize;

use super::box_plot::BoxPlot;
use super::continuity::Continuity;
use super::durations::NamedPercentiles;
use super::events::EventLine;
use super::log_histogram::LogBin;
use super::origin::{FileEnd, Origin};
use super::plots::{Curve, Plot, ValueRange};
use super::states::StateSpan;
use super::terms::Terms;
use super::thesis::ThesisFigures;

/// A report on a recorded run. Serialized, it holds every statistic; the plots
/// are in the page.
#[derive(Clone, Debug, Serialize)]
pub struct Report<A> {
    /// The part for every loop.
    #[serde(flatten)]
    pub run: RunReport,
    /// The part for this kind of plant.
    #[serde(flatten)]
    pub addition: A,
}

impl<A> Deref for Report<A> {
    type Target = RunReport;

    fn deref(&self) -> &RunReport {
        &self.run
    }
}

/// The part of a report for every plant.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    /// Origin of the recording.
    pub origin: Origin,
    /// How the file ends.
    pub end: FileEnd,
    /// What in it is damaged.
    pub damages: Vec<Damage>,
    /// First tick to last, s.
    pub duration_s: f64,
    /// The summary.
    pub findings: Vec<String>,
    /// Whether every tick is there.
    pub continuity: Continuity,
    /// Timing of the loop; `None` without a tick.
    pub timing: Option<Timing>,
    /// Durations of the stages of a tick.
    pub stages: Vec<NamedPercentiles>,
    /// Ages of the measurements when the loop woke.
    pub sensor_ages: Vec<NamedPercentiles>,
    /// The states of the loop over time.
    pub states: Vec<StateSpan>,
    /// How often the loop entered failsafe.
    pub failsafes: u64,
    /// The first two thousand events.
    pub events: Vec<EventLine>,
    /// Number of events.
    pub event_count: usize,
    /// Ranges of measurements, set points and outputs; empty for a plant whose
    /// addition shows them better.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<ValueRange>,
    #[serde(skip)]
    pub(super) terms: Terms,
    #[serde(skip)]
    pub(super) plots: Vec<Plot>,
    #[serde(skip)]
    pub(super) lateness: Curve,
}

impl RunReport {
    /// Whether the whole recording was read.
    pub fn is_complete(&self) -> bool {
        self.damages.is_empty() && !matches!(self.end, FileEnd::Cut(_))
    }

    /// Whether any measurement was older than its tick.
    pub(super) fn has_ages(&self) -> bool {
        self.sensor_ages.iter().any(|row| row.of.max_us > 0.0)
    }
}

impl Timing {
    /// Whether the loop ran in lockstep, without a clock.
    pub(super) fn is_lockstep(&self) -> bool {
        self.table.lateness_us.max == 0.0 && self.table.period_ms.range == 0.0
    }
}

/// Timing of the loop.
#[derive(Clone, Debug, Serialize)]
pub struct Timing {
    /// The thesis' table and the lateness.
    #[serde(flatten)]
    pub table: TimingReport,
    /// Box plot of the period, ms (thesis, figures 6.1 to 6.3); `None` before
    /// the second tick.
    pub period_box_ms: Option<BoxPlot>,
    /// Lateness of the wake-ups.
    pub lateness_histogram: Vec<LogBin>,
    /// The thesis' measurements at this rate.
    pub thesis: Option<ThesisFigures>,
}
