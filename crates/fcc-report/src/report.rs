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
use super::thesis::ThesisFigures;
use super::words::Words;

/// All that is said of a recorded run. Serialized, it is every statistic in it;
/// the plots are in the page.
#[derive(Clone, Debug, Serialize)]
pub struct Report<A> {
    /// What every loop's recording says.
    #[serde(flatten)]
    pub run: RunReport,
    /// What only this plant's recording says.
    #[serde(flatten)]
    pub addition: A,
}

impl<A> Deref for Report<A> {
    type Target = RunReport;

    fn deref(&self) -> &RunReport {
        &self.run
    }
}

/// What is said of a recorded run, whatever the plant.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    /// Where the recording comes from.
    pub origin: Origin,
    /// How the file ends.
    pub end: FileEnd,
    /// What in it is damaged.
    pub damages: Vec<Damage>,
    /// First tick to last, s.
    pub duration_s: f64,
    /// What is worth saying first, in words.
    pub findings: Vec<String>,
    /// Whether every tick is there.
    pub continuity: Continuity,
    /// How well the loop kept time; none without a tick.
    pub timing: Option<Timing>,
    /// How long the stages of a tick took.
    pub stages: Vec<NamedPercentiles>,
    /// How old the measurements were when the loop woke.
    pub sensor_ages: Vec<NamedPercentiles>,
    /// Which state the loop was in, and when.
    pub states: Vec<StateSpan>,
    /// How often the loop fell into failsafe.
    pub failsafes: u64,
    /// What happened; the first two thousand.
    pub events: Vec<EventLine>,
    /// How many events there were.
    pub event_count: usize,
    /// What measurements, set points and outputs ranged over; empty for a
    /// plant whose results say it better.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<ValueRange>,
    #[serde(skip)]
    pub(super) words: Words,
    #[serde(skip)]
    pub(super) plots: Vec<Plot>,
    #[serde(skip)]
    pub(super) lateness: Curve,
}

impl RunReport {
    /// Whether all that was recorded could be read.
    pub fn is_complete(&self) -> bool {
        self.damages.is_empty() && !matches!(self.end, FileEnd::Cut(_))
    }

    /// Whether any measurement was older than its tick.
    pub(super) fn has_ages(&self) -> bool {
        self.sensor_ages.iter().any(|row| row.of.max_us > 0.0)
    }
}

impl Timing {
    /// Whether the loop never waited for a clock: its timing is none.
    pub(super) fn is_lockstep(&self) -> bool {
        self.table.lateness_us.max == 0.0 && self.table.period_ms.range == 0.0
    }
}

/// How well the loop kept time.
#[derive(Clone, Debug, Serialize)]
pub struct Timing {
    /// The thesis' table and the lateness.
    #[serde(flatten)]
    pub table: TimingReport,
    /// Box plot of the period, ms (thesis, figures 6.1 to 6.3); none before
    /// the second tick.
    pub period_box_ms: Option<BoxPlot>,
    /// Lateness of the wake-ups.
    pub lateness_histogram: Vec<LogBin>,
    /// What the thesis measured at this rate.
    pub thesis: Option<ThesisFigures>,
}
