//! The plots of a report: SVG inside a page, without other files, legible in
//! black and white as well as in colour.
//!
//! One style for all: actual values are a dark solid line, desired ones a thin
//! dashed line; legends are above the data; axes have units; every plot over
//! time has the same time axis, tinted while the loop was not engaged, with the
//! events numbered as in the table.

pub(crate) mod axis;
mod curves;
pub(crate) mod figure;
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
#[cfg(feature = "flight")]
pub(crate) use time_plots::figure;

use super::report::RunReport;

/// The figures of a page, by section.
#[derive(Default)]
pub(super) struct Figures {
    /// States and events.
    pub(super) timeline: Vec<Figure>,
    /// Measurements, set points and outputs.
    pub(super) values: Vec<Figure>,
    /// Timing of the loop.
    pub(super) timing: Vec<Figure>,
}

/// Draws all figures that have data.
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
