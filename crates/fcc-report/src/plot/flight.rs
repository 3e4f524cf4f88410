//! How the aircraft flew: the thesis' figures 6.4 and 6.5, and what belongs
//! beside them.

use super::super::Report;
use super::super::lines::Pair;
use super::super::trace::{Point, Trace};
use super::axis::{Axis, extent, number};
use super::canvas::PlotError;
use super::time_figure::{Ink, TimePanel, time_figure};
use super::{Figure, ground_track};

/// The figures that there are data for.
pub(super) fn figures(report: &Report) -> Result<Vec<Figure>, PlotError> {
    let lines = &report.lines;
    let mut figures = vec![
        Figure {
            title: "Heading",
            caption: "Magnetic heading, desired and actual, which is what the navigation made of what was measured (thesis, figure 6.4).".to_owned(),
            svg: time_figure(
                report,
                "Heading over time, desired and actual",
                &[heading(&lines.heading_deg)],
            )?,
        },
        Figure {
            title: "Altitude and pitch",
            caption: "Barometric altitude, desired and actual, and below it the pitch that \
                      makes it (thesis, figure 6.5)."
                .to_owned(),
            svg: time_figure(
                report,
                "Altitude and pitch over time, desired and actual",
                &[
                    pair(&lines.altitude_ft, 170.0, 20.0, "altitude, ft"),
                    pair(&lines.pitch_deg, 90.0, 2.0, "pitch, °"),
                ],
            )?,
        },
        Figure {
            title: "Airspeed and throttle",
            caption: "Indicated airspeed, desired and actual, and the throttle commanded."
                .to_owned(),
            svg: time_figure(
                report,
                "Airspeed and throttle over time",
                &[
                    pair(&lines.airspeed_kt, 130.0, 4.0, "airspeed, kt"),
                    throttle(&lines.throttle_percent),
                ],
            )?,
        },
        Figure {
            title: "Bank and surfaces",
            caption: "Bank, desired and actual, and the surfaces commanded, all three on the \
                      same scale: 1 is full deflection; positive raises the nose, rolls right, \
                      yaws right."
                .to_owned(),
            svg: time_figure(
                report,
                "Bank and control surfaces over time",
                &bank_and_surfaces(report),
            )?,
        },
    ];
    figures.extend(ground_track::figure(report)?);
    Ok(figures)
}

impl Pair {
    fn traces(&self) -> [&Trace; 3] {
        [&self.measured, &self.actual, &self.desired]
    }

    /// Each with its ink, the one that is drawn last on top.
    fn lines(&self) -> Vec<(Ink, Vec<Vec<Point>>)> {
        let inks = [Ink::Measured, Ink::Actual, Ink::Desired];
        inks.into_iter()
            .zip(self.traces().map(Trace::lines))
            .collect()
    }
}

fn pair(of: &Pair, height_px: f64, least_span: f64, title: &str) -> TimePanel {
    let count = (height_px / 32.0) as usize;
    TimePanel {
        height_px,
        y: Axis::around(extent(of.traces()), least_span, count, title),
        lines: of.lines(),
    }
}

/// Counted on through full turns, so that no line jumps at north; the words
/// of the axis are those of the compass.
fn heading(of: &Pair) -> TimePanel {
    const TITLE: &str = "heading, °";
    let compass = |at: f64| format!("{:03.0}", at.rem_euclid(360.0).round() % 360.0);
    let axis = Axis::around(extent(of.traces()), 20.0, 5, TITLE);
    let range = (axis.from, axis.to);
    let step = match range.1 - range.0 {
        span if span > 3_600.0 => 360.0 * (span / 3_600.0).ceil(),
        span if span > 2_160.0 => 360.0,
        span if span > 1_080.0 => 180.0,
        span if span > 360.0 => 90.0,
        span if span > 200.0 => 45.0,
        span if span > 90.0 => 30.0,
        span if span > 40.0 => 10.0,
        _ => 5.0,
    };
    // Where every tick is at north, its words count the turns.
    let y = if step < 360.0 {
        Axis::stepped(range, step, TITLE, compass)
    } else {
        Axis::stepped(range, step, "heading, turns", |at| number(at / 360.0, 0))
    };
    TimePanel {
        height_px: 200.0,
        y,
        lines: of.lines(),
    }
}

fn throttle(of: &Trace) -> TimePanel {
    TimePanel {
        height_px: 80.0,
        y: Axis::stepped((-4.0, 104.0), 25.0, "throttle, %", |at| format!("{at:.0}")),
        lines: vec![(Ink::Actual, of.lines())],
    }
}

fn bank_and_surfaces(report: &Report) -> Vec<TimePanel> {
    let lines = &report.lines;
    let surfaces = [
        (&lines.aileron, "aileron"),
        (&lines.elevator, "elevator"),
        (&lines.rudder, "rudder"),
    ];
    let all = extent(surfaces.map(|(trace, _)| trace));
    let mut panels = vec![pair(&lines.bank_deg, 120.0, 5.0, "bank, °")];
    panels.extend(surfaces.map(|(trace, title)| TimePanel {
        height_px: 64.0,
        y: Axis::around(all, 0.1, 3, title),
        lines: vec![(Ink::Actual, trace.lines())],
    }));
    panels
}
