//! The plots of a report: SVG that stands inside a page, prints in black and
//! white as well as in colour, and needs nothing from elsewhere.
//!
//! One style for all: what is actual is a dark solid line, what is desired a
//! thin dashed one; legends stand above the data and never on it; axes carry
//! their unit; every plot over time has the same time axis, tinted where the
//! loop was not engaged, with the events numbered as in the table.

pub(crate) mod axis;
mod curves;
mod figure;
mod marks;
pub(crate) mod panel;
mod percentile_ranges;
pub(crate) mod sheet;
mod time_figure;
mod time_plots;
mod timeline;
mod timing;

pub(crate) use curves::Detail;
pub use figure::Figure;

use super::report::RunReport;

/// The figures of a page, by its sections.
#[derive(Default)]
pub(super) struct Figures {
    /// States and events.
    pub(super) timeline: Vec<Figure>,
    /// Measurements, set points and outputs.
    pub(super) values: Vec<Figure>,
    /// How the loop kept time.
    pub(super) timing: Vec<Figure>,
}

/// Draws all that there is to draw.
pub(super) fn figures(report: &RunReport, detail: Detail) -> Figures {
    if report.continuity.ticks == 0 {
        return Figures::default();
    }
    let detail = detail.shared_by(report);
    Figures {
        timeline: vec![timeline::timeline(report)],
        values: time_plots::figures(report, detail),
        timing: timing::figures(report, detail),
    }
}
