//! Reports on recordings: as text, JSON, an HTML page, SVG and CSV.
//!
//! ```text
//! messages ─► Survey ─► Report ─► tables, JSON, one HTML page
//!        └──► CsvFolder
//! ```
//!
//! A [`Survey`] reads the messages once, in memory that does not grow with the
//! recording: lines are thinned to the resolution of a plot, and durations are
//! counted in histograms. It works for every controller whose values are
//! declared; results of one kind of plant, such as the score of a flight, are
//! an [`Addition`].
//!
//! Values inside are in SI; a report has display units, with the unit in every
//! name.

mod box_plot;
mod continuity;
mod csv;
mod durations;
mod events;
mod findings;
#[cfg(feature = "flight")]
mod flight;
mod log_histogram;
mod origin;
mod page;
mod plot;
mod plots;
mod reported;
mod spread;
mod states;
mod survey;
mod table;
mod text;
mod thesis;
mod trace;
mod turns;

use std::ops::Deref;

use serde::Serialize;

pub use box_plot::BoxPlot;
pub use continuity::{Continuity, Gap};
pub use csv::CsvFolder;
pub use durations::NamedPercentiles;
pub use events::EventLine;
#[cfg(feature = "flight")]
pub use flight::{FlightAddition, FlightReport, FlightSurvey, flight_table};
pub use log_histogram::LogBin;
pub use origin::{FileEnd, Origin};
pub use plot::Figure;
pub use plots::{Panel, Plot, Quantities, ValueRange};
pub use reported::{Addition, Reported, Terms};
pub use spread::Percentiles;
pub use states::StateSpan;
pub use survey::Survey;
pub use table::{recordings_table, timing_table};
pub use thesis::ThesisFigures;

use fcc_record::Damage;
use fcc_telemetry::TimingReport;
use plots::Curve;

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
    /// Damages of the recording.
    pub damages: Vec<Damage>,
    /// First tick to last, s.
    pub duration_s: f64,
    /// The summary.
    pub findings: Vec<String>,
    /// Missing ticks.
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
    terms: Terms,
    #[serde(skip)]
    plots: Vec<Plot>,
    #[serde(skip)]
    lateness: Curve,
}

impl RunReport {
    /// Whether the whole recording was read.
    pub fn is_complete(&self) -> bool {
        self.damages.is_empty() && !matches!(self.end, FileEnd::Cut(_))
    }

    /// Whether any measurement was older than its tick.
    fn has_ages(&self) -> bool {
        self.sensor_ages.iter().any(|row| row.of.max_us > 0.0)
    }
}

impl Timing {
    /// Whether the loop ran in lockstep, without a clock.
    fn is_lockstep(&self) -> bool {
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
