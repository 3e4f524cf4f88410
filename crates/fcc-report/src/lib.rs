//! After the flight: what a recording tells, for people, for tools and for
//! paper.
//!
//! ```text
//! messages ─► Survey ─► Report ─► tables, JSON, one HTML page
//!        └──► CsvFolder
//! ```
//!
//! A [`Survey`] goes over the messages once, in memory that does not grow with
//! the recording: lines are thinned to what a plot can show, durations are
//! counted in histograms, and a flight is scored leg by leg. Everything that
//! it was told is in the [`Report`]; nothing of it is asserted that was not
//! recorded.
//!
//! Inside is SI; a report is for people and speaks feet, knots and degrees,
//! with the unit in every name.

mod box_plot;
mod continuity;
mod csv;
mod durations;
mod events;
mod findings;
mod lines;
mod log_histogram;
mod origin;
mod page;
mod plot;
mod scoring;
mod spread;
mod states;
mod survey;
mod table;
mod text;
mod thesis;
mod trace;
mod track;
mod turns;

use serde::Serialize;

pub use box_plot::BoxPlot;
pub use continuity::{Continuity, Gap};
pub use csv::CsvFolder;
pub use durations::NamedPercentiles;
pub use events::EventLine;
pub use log_histogram::LogBin;
pub use origin::{FileEnd, Origin};
pub use plot::PlotError;
pub use spread::Percentiles;
pub use states::StateSpan;
pub use survey::Survey;
pub use table::{flight_table, recordings_table, timing_table};
pub use thesis::ThesisFigures;

use fcc_record::Damage;
use fcc_telemetry::{FlightScore, TimingReport};
use lines::Lines;
use track::TrackPoint;

/// All that is said of a recorded flight. Serialized, it is every statistic
/// in it; the plots are in the page.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Where the flight comes from.
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
    /// How well the timed pattern was flown, by what was measured; none
    /// without a whole leg.
    pub flight: Option<FlightScore>,
    /// Why a part of the flight has no score.
    pub not_scored: Option<String>,
    #[serde(skip)]
    lines: Lines,
    #[serde(skip)]
    track: Vec<TrackPoint>,
}

impl Report {
    /// Whether all that was recorded could be read.
    pub fn is_complete(&self) -> bool {
        self.damages.is_empty() && !matches!(self.end, FileEnd::Cut(_))
    }

    /// Whether any measurement was older than its tick.
    fn has_ages(&self) -> bool {
        self.sensor_ages.iter().any(|row| row.of.max_us > 0.0)
    }
}

impl Timing {
    /// Whether the loop never waited for a clock: its timing is none.
    fn is_lockstep(&self) -> bool {
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
