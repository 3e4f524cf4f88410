//! Plots over time, one panel above another.

use std::fmt::Write as _;

use plotters::prelude::*;

use super::super::RunReport;
use super::super::plots::Curve;
use super::super::states::Phase;
use super::super::trace::Point;
use super::axis::Axis;
use super::canvas::{
    Area, Drawn, FAINT, GRID, LABEL_PX, PlotError, SMALL_PX, Sample, TEXT, WIDTH_PX, draw, hex,
    legend, pen, px,
};
use super::curves::{Detail, Ink, is_dense, markup};
use super::marks::{Mark, marks};
use super::panel::{Frame, Panel};

/// Left and right edge of all panels over time, px: the same in every figure,
/// so that figures can be compared.
pub(super) const LEFT_PX: f64 = 60.0;
pub(super) const RIGHT_PX: f64 = WIDTH_PX - 12.0;

const LEGEND_PX: f64 = 20.0;
const MARKS_PX: f64 = 14.0;
const BETWEEN_PX: f64 = 12.0;
const X_LABELS_PX: f64 = 36.0;

/// Missing records.
const GAP: RGBColor = RGBColor(255, 238, 170);

/// A panel of a figure over time.
pub(super) struct TimePanel<'a> {
    pub(super) height_px: f64,
    pub(super) y: Axis,
    /// Drawn in this order.
    pub(super) curves: &'a [Curve],
}

/// Draws panels over the time of a report.
pub(super) fn time_figure(
    report: &RunReport,
    label: &str,
    detail: Detail,
    panels: &[TimePanel<'_>],
) -> Result<String, PlotError> {
    let top = LEGEND_PX + MARKS_PX;
    let mut bottom = top - BETWEEN_PX;
    let mut frames = Vec::new();
    for panel in panels {
        let top = bottom + BETWEEN_PX;
        bottom = top + panel.height_px;
        frames.push(Frame {
            left: LEFT_PX,
            top,
            right: RIGHT_PX,
            bottom,
        });
    }
    let axis = time_axis(report);
    let mut svg = draw(bottom + X_LABELS_PX, label, |area| {
        legend_of(area, report, panels)?;
        for (panel, frame) in panels.iter().zip(&frames) {
            // What moves when the plot is zoomed in time is not the library's.
            let bare = Axis {
                ticks: Vec::new(),
                ..axis.clone()
            };
            let mut drawn = Panel::new(area, *frame, bare, panel.y.clone())?;
            drawn.axes(frame.bottom == bottom)?;
        }
        Ok(())
    })?;
    let marks = marks(&report.events, |time_s| time_px(report, time_s));
    let mut labels = String::new();
    for (at_s, label) in &axis.ticks {
        let (x, y) = (px(time_px(report, *at_s)), px(bottom + 6.0));
        let _ = write!(
            labels,
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.76em\">{label}</text>"
        );
    }
    let size = px(LABEL_PX);
    labels = format!(
        "<g class=\"times\" text-anchor=\"middle\" font-size=\"{size}\" fill=\"{}\">{labels}</g>\n",
        hex(TEXT)
    );
    for mark in &marks {
        let (x, y, size) = (px(mark.at_px), px(top - 1.0), px(SMALL_PX));
        let _ = writeln!(
            labels,
            "<text class=\"mark\" x=\"{x}\" y=\"{y}\" dy=\"-0.5ex\" text-anchor=\"middle\" \
             font-size=\"{size}\" fill=\"{}\" data-at=\"{x}\">{}</text>",
            hex(FAINT),
            mark.label()
        );
    }
    let panels = panels.iter().zip(&frames);
    let lines = panels.map(|(panel, frame)| lines(report, panel, *frame, detail));
    let lines: String = lines.collect();
    let end = svg.rfind("</svg>").unwrap_or(svg.len());
    svg.insert_str(end, &(lines + &labels));
    let grounds: String = frames
        .iter()
        .map(|frame| ground(report, *frame, &axis, &marks))
        .collect();
    let begin = svg.find('>').map_or(0, |at| at + 1);
    svg.insert_str(begin, &grounds);
    // For the page's script: where the axis of time is.
    let (left, right) = (px(LEFT_PX), px(RIGHT_PX));
    let (end_s, unit_s) = (end_s(report), unit(report).0);
    let axis = format!(
        " data-left=\"{left}\" data-right=\"{right}\" data-end=\"{end_s}\" data-unit=\"{unit_s}\""
    );
    svg.insert_str("<svg".len(), &axis);
    Ok(svg)
}

/// What is drawn over time in a panel, from its upper left corner: a part of the
/// sheet that can be zoomed by itself.
fn zoomable(frame: Frame, content: &str) -> String {
    let (x, y) = (px(frame.left), px(frame.top));
    let (width, height) = (px(frame.right - frame.left), px(frame.bottom - frame.top));
    format!(
        "<svg class=\"time\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" preserveAspectRatio=\"none\">\n{content}</svg>\n"
    )
}

fn lines(report: &RunReport, panel: &TimePanel<'_>, frame: Frame, detail: Detail) -> String {
    let (y, height_px) = (&panel.y, frame.bottom - frame.top);
    let on_panel = |point: Point| {
        let share = (y.to - point.value) / (y.to - y.from);
        (time_px(report, point.time_s) - LEFT_PX, share * height_px)
    };
    let curves = panel.curves.iter();
    let curves: String = curves
        .map(|curve| markup(curve, is_dense(report), detail, on_panel))
        .collect();
    zoomable(frame, &curves)
}

/// Tints, the grid of the time and the marks of events.
fn ground(report: &RunReport, frame: Frame, axis: &Axis, marks: &[Mark]) -> String {
    let height = px(frame.bottom - frame.top);
    let at = |time_s: f64| px(time_px(report, time_s) - LEFT_PX);
    let mut content = String::new();
    let states = report.states.iter();
    let tints = states.filter_map(|span| Some((span.from_s, span.to_s, tint(span.phase)?)));
    let gaps = report.continuity.gaps.iter();
    let gaps = gaps.map(|gap| (gap.from_s, gap.to_s, GAP));
    for (from_s, to_s, colour) in tints.chain(gaps) {
        // One too short to be seen is seen all the same.
        let (x, width) = (at(from_s), (at(to_s) - at(from_s)).max(px(1.0)));
        let _ = writeln!(
            content,
            "<rect x=\"{x}\" y=\"0\" width=\"{width}\" height=\"{height}\" fill=\"{}\"/>",
            hex(colour)
        );
    }
    let mut upright = |class: &str, colour: RGBColor, places: &mut dyn Iterator<Item = i32>| {
        let places: Vec<String> = places.map(|x| format!("M{x} 0v{height}")).collect();
        let path = places.concat();
        let _ = writeln!(
            content,
            "<path class=\"{class}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" d=\"{path}\"/>",
            hex(colour),
            px(0.6)
        );
    };
    upright(
        "grid",
        GRID,
        &mut axis.ticks.iter().map(|(time_s, _)| at(*time_s)),
    );
    let marked = marks.iter().map(|mark| px(mark.at_px - LEFT_PX));
    upright("marks", RGBColor(190, 190, 190), &mut marked.into_iter());
    zoomable(frame, &content)
}

/// What lines and tints mean, in a row above the panels.
fn legend_of(area: &Area<'_>, report: &RunReport, panels: &[TimePanel<'_>]) -> Drawn {
    let curves = panels.iter().flat_map(|panel| panel.curves);
    let drawn: Vec<&Curve> = curves.filter(|curve| curve.trace.len() > 0).collect();
    let of = |ink: Ink| drawn.iter().find(|curve| curve.ink == ink);
    let mut entries: Vec<_> = [Ink::Measured, Ink::Actual, Ink::Desired]
        .into_iter()
        .filter_map(of)
        .map(|curve| {
            let (colour, width_px) = curve.ink.pen(false);
            (Sample::Line(pen(colour, width_px)), curve.name)
        })
        .collect();
    // One line needs no name.
    if entries.len() == 1 {
        entries.clear();
    }
    let in_phase = |phase: Phase| report.states.iter().any(|span| span.phase == phase);
    let phases = [Phase::Standby, Phase::Failsafe, Phase::Stopped].into_iter();
    let tints = phases
        .filter(|phase| in_phase(*phase))
        .filter_map(|phase| Some((tint(phase)?, phase_name(phase))))
        .chain((report.continuity.lost > 0).then_some((GAP, "records missing")));
    entries.extend(tints.map(|(tint, name)| (Sample::Block(tint), name)));
    legend(area, LEFT_PX, LEGEND_PX / 2.0 - 1.0, entries)
}

/// The background of a panel while the loop was not engaged.
pub(super) fn tint(phase: Phase) -> Option<RGBColor> {
    match phase {
        Phase::Engaged => None,
        Phase::Standby => Some(RGBColor(240, 240, 238)),
        Phase::Failsafe => Some(RGBColor(251, 222, 214)),
        Phase::Stopped => Some(RGBColor(216, 216, 214)),
    }
}

pub(super) fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Standby => "standby",
        Phase::Engaged => "engaged",
        Phase::Failsafe => "failsafe",
        Phase::Stopped => "stopped",
    }
}

/// Position of a time on the sheet, px.
pub(super) fn time_px(report: &RunReport, time_s: f64) -> f64 {
    let share = (time_s / end_s(report)).clamp(0.0, 1.0);
    LEFT_PX + share * (RIGHT_PX - LEFT_PX)
}

fn end_s(report: &RunReport) -> f64 {
    // One tick has no duration, but the axis needs one.
    report.duration_s.max(0.1)
}

/// The axis of time: its coordinate is in seconds, its labels in a suitable
/// unit.
pub(super) fn time_axis(report: &RunReport) -> Axis {
    let (end_s, (unit_s, unit)) = (end_s(report), unit(report));
    let mut axis = Axis::exactly(
        (0.0, end_s / unit_s),
        12,
        &format!("time since the first tick, {unit}"),
    );
    axis.to = end_s;
    for (at, _) in &mut axis.ticks {
        *at *= unit_s;
    }
    axis
}

/// The unit of the time axis, s, and its symbol.
fn unit(report: &RunReport) -> (f64, &'static str) {
    match end_s(report) {
        end_s if end_s <= 300.0 => (1.0, "s"),
        end_s if end_s <= 10_800.0 => (60.0, "min"),
        _ => (3_600.0, "h"),
    }
}
