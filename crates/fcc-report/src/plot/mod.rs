//! The plots of a report: SVG that stands inside a page, prints in black and
//! white as well as in colour, and needs nothing from elsewhere.
//!
//! One style for all: what is actual is a dark solid line, what is desired a
//! thin dashed one; legends stand above the data and never on it; axes carry
//! their unit; every plot over time has the same time axis, tinted where the
//! autopilot was not engaged, with the events numbered as in the table.

mod axis;
mod canvas;
mod flight;
mod ground_track;
mod marks;
mod panel;
mod percentile_ranges;
mod time_figure;
mod timeline;
mod timing;

pub use canvas::PlotError;

use super::Report;

/// A plot with its words.
pub(super) struct Figure {
    /// What it shows.
    pub(super) title: &'static str,
    /// How to read it.
    pub(super) caption: String,
    /// The picture.
    pub(super) svg: String,
}

/// The figures of a page, by its sections.
pub(super) struct Figures {
    /// States and events.
    pub(super) timeline: Vec<Figure>,
    /// How the aircraft flew.
    pub(super) flight: Vec<Figure>,
    /// How the loop kept time.
    pub(super) timing: Vec<Figure>,
}

impl Figures {
    /// In the order of the page.
    pub(super) fn into_all(self) -> impl Iterator<Item = Figure> {
        let sections = [self.timeline, self.flight, self.timing];
        sections.into_iter().flatten()
    }
}

/// Draws all that there is to draw.
pub(super) fn figures(report: &Report) -> Result<Figures, PlotError> {
    if report.continuity.ticks == 0 {
        return Ok(Figures {
            timeline: Vec::new(),
            flight: Vec::new(),
            timing: Vec::new(),
        });
    }
    Ok(Figures {
        timeline: vec![timeline::timeline(report)?],
        flight: flight::figures(report)?,
        timing: timing::figures(report)?,
    })
}
