//! How the aircraft flew: the thesis' figures 6.4 and 6.5, and what belongs
//! beside them.

use super::super::Report;
use super::super::lines::Pair;
use super::super::trace::{Point, Trace};
use super::super::turns::{fold, seam_deg};
use super::axis::{Axis, extent};
use super::canvas::PlotError;
use super::time_figure::{Ink, TimePanel, time_figure};
use super::{Figure, ground_track};

/// The figures that there are data for.
pub(super) fn figures(report: &Report) -> Result<Vec<Figure>, PlotError> {
    let lines = &report.lines;
    let mut figures = vec![
        Figure {
            title: "Heading",
            caption: "Magnetic heading, desired and actual (thesis, figure 6.4).".to_owned(),
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

fn pair(of: &Pair, height_px: f64, least_span: f64, title: &str) -> TimePanel {
    let count = (height_px / 32.0) as usize;
    TimePanel {
        height_px,
        y: Axis::around(extent([&of.actual, &of.desired]), least_span, count, title),
        lines: vec![
            (Ink::Actual, of.actual.lines()),
            (Ink::Desired, of.desired.lines()),
        ],
    }
}

/// A full turn at most is drawn as it is; more is folded into one, cut where
/// least is flown.
fn heading(of: &Pair) -> TimePanel {
    const TITLE: &str = "heading, °";
    let compass = |at: f64| format!("{:03.0}", at.rem_euclid(360.0).round() % 360.0);
    let (low, high) = extent([&of.actual, &of.desired]);
    let (mut actual, mut desired) = (of.actual.lines(), of.desired.lines());
    let range = if high - low <= 360.0 {
        let axis = Axis::around((low, high), 20.0, 5, TITLE);
        (axis.from, axis.to)
    } else {
        let held = if desired.is_empty() {
            &actual
        } else {
            &desired
        };
        let seam = seam_deg(held);
        let folded =
            |lines: Vec<Vec<Point>>| lines.iter().flat_map(|line| fold(line, seam)).collect();
        (actual, desired) = (folded(actual), folded(desired));
        (seam, seam + 360.0)
    };
    let step = match range.1 - range.0 {
        span if span > 200.0 => 45.0,
        span if span > 90.0 => 30.0,
        span if span > 40.0 => 10.0,
        _ => 5.0,
    };
    TimePanel {
        height_px: 200.0,
        y: Axis::stepped(range, step, TITLE, compass),
        lines: vec![(Ink::Actual, actual), (Ink::Desired, desired)],
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
