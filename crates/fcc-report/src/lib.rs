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
mod report;
mod reported;
mod spread;
mod states;
mod survey;
mod table;
mod terms;
mod text;
mod thesis;
mod trace;
mod turns;

pub use box_plot::BoxPlot;
pub use continuity::{Continuity, Gap};
pub use csv::{CsvFolder, TABLES};
pub use durations::NamedPercentiles;
pub use events::EventLine;
#[cfg(feature = "flight")]
pub use flight::{
    AltimeterSettings, Difference, FlightAddition, FlightReport, FlightSurvey, FlownItem,
    FlownPlan, GroundLine, GroundPoint, MethodResult, NavigationReplay, PlanFence, PlanLine,
    PlanLines, PlanPlace, PlanRow, ReplacedPlan, ReplacedPlans, SourceConsistency, TouchDown,
    flight_table, plan_page, plan_table,
};
pub use log_histogram::LogBin;
pub use origin::{FileEnd, Origin};
pub use plot::Figure;
pub use plots::{Panel, Plot, Quantities, Scale, ValueRange};
pub use report::{Report, RunReport, Timing};
pub use reported::{Addition, Reported};
pub use spread::Percentiles;
pub use states::StateSpan;
pub use survey::Survey;
pub use table::{recordings_table, timing_table};
pub use terms::Terms;
pub use thesis::ThesisFigures;
