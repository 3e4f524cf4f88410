//! Plots over time, one panel above another.

use maud::html;

use super::super::plots::{Curve, Ink};
use super::super::report::RunReport;
use super::super::states::Phase;
use super::super::trace::Point;
use super::axis::Axis;

use super::curves::{Detail, is_dense, markup};
use super::marks::{Mark, marks};
use super::panel::{Frame, Panel};
use super::sheet::{
    Anchor, Colour, FAINT, Font, GRID, Height, LABEL_PX, MARK, SMALL_PX, Sample, Sheet, TEXT,
    WIDTH_PX, px,
};

/// Left and right edge of all panels over time, px: the same in every figure,
/// so that figures can be compared.
pub(super) const LEFT_PX: f64 = 60.0;
pub(super) const RIGHT_PX: f64 = WIDTH_PX - 12.0;

const LEGEND_PX: f64 = 20.0;
const MARKS_PX: f64 = 14.0;
const BETWEEN_PX: f64 = 12.0;
const X_LABELS_PX: f64 = 36.0;

/// Missing records.
const GAP: Colour = "#FFEEAA";

/// A panel of a figure over time.
pub(super) struct TimePanel<'a> {
    pub(super) height_px: f64,
    pub(super) y: Axis,
    /// Whether they are directions, drawn within one turn.
    pub(super) fold: bool,
    pub(super) refit: Refit,
    /// Drawn in this order.
    pub(super) curves: &'a [Curve],
}

/// How the page's script fits the vertical axis to the part of the time that is
/// shown.
#[derive(Clone, Copy)]
pub(super) struct Refit {
    pub(super) kind: Kind,
    /// The least span.
    pub(super) least: f64,
    /// Values per unit of the labels.
    pub(super) per: f64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Not at all.
    Fixed,
    /// To its own lines.
    Line,
    /// To those of all such panels.
    Together,
    /// To its own directions.
    Compass,
}

impl Refit {
    /// The attributes of a panel's values.
    fn attributes(self, axis: &Axis) -> String {
        let kind = match self.kind {
            Kind::Fixed => return String::new(),
            Kind::Line => "line",
            Kind::Together => "together",
            Kind::Compass => "compass",
        };
        let Self { least, per, .. } = self;
        let (from, to) = (axis.from, axis.to);
        format!(
            " data-kind=\"{kind}\" data-from=\"{from}\" data-to=\"{to}\" data-least=\"{least}\" \
             data-per=\"{per}\""
        )
    }
}

/// Draws panels over the time of a report.
pub(super) fn time_figure(
    report: &RunReport,
    label: &str,
    detail: Detail,
    panels: &[TimePanel<'_>],
) -> String {
    let top = LEGEND_PX + MARKS_PX;
    let mut bottom = top - BETWEEN_PX;
    let axis = time_axis(report);
    let marks = marks(&report.events, |time_s| time_px(report, time_s));
    let mut sheet = Sheet::default();
    sheet.legend((LEFT_PX, LEGEND_PX / 2.0 - 1.0), legend(report, panels));
    for (number, panel) in panels.iter().enumerate() {
        let top = bottom + BETWEEN_PX;
        bottom = top + panel.height_px;
        let frame = Frame {
            left: LEFT_PX,
            top,
            right: RIGHT_PX,
            bottom,
        };
        ground(&mut sheet, report, frame, &axis, &marks);
        // The ticks of the time are drawn apart: they move when it is zoomed.
        let axes = Panel {
            frame,
            x: Axis {
                ticks: Vec::new(),
                ..axis.clone()
            },
            y: panel.y.clone(),
        };
        let last = number + 1 == panels.len();
        axes.axes(&mut sheet, last, &panel.refit.attributes(&panel.y));
        zoomable(&mut sheet, "time curves", frame, |sheet| {
            for curve in panel.curves {
                let on_panel = |point: Point| {
                    let (x, y) = axes.place((point.time_s, point.value));
                    (x - LEFT_PX, y - top)
                };
                markup(sheet, curve, is_dense(report), panel.fold, detail, on_panel);
            }
        });
    }
    sheet.raw(format_args!("<g class=\"times\">"));
    for (at_s, label) in &axis.ticks {
        let font = Font(LABEL_PX, TEXT, Anchor::Middle, Height::Top);
        sheet.text((time_px(report, *at_s), bottom + 6.0), label, font);
    }
    sheet.raw(format_args!("</g>"));
    for mark in &marks {
        let font = Font(SMALL_PX, FAINT, Anchor::Middle, Height::Bottom);
        let words = html! { title { (mark.description(&report.events)) } };
        sheet.raw(format_args!("<g>{}", words.into_string()));
        sheet.transformed_text((mark.at_px, top - 1.0), &mark.label(), font, "mark", "");
        sheet.raw(format_args!("</g>"));
    }
    // For the page's script: the position of the time axis.
    let data = [
        ("left", f64::from(px(LEFT_PX))),
        ("right", f64::from(px(RIGHT_PX))),
        ("end", end_s(report)),
        ("unit", unit(report).0),
    ];
    sheet.finish(bottom + X_LABELS_PX, label, &data)
}

/// The content of a panel, from its upper left corner: a part of the sheet that
/// can be zoomed by itself.
fn zoomable(sheet: &mut Sheet, class: &str, frame: Frame, draw: impl FnOnce(&mut Sheet)) {
    let (x, y) = (px(frame.left), px(frame.top));
    let (width, height) = (px(frame.right - frame.left), px(frame.bottom - frame.top));
    sheet.raw(format_args!(
        "<svg class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" preserveAspectRatio=\"none\">"
    ));
    draw(sheet);
    sheet.raw(format_args!("</svg>"));
}

/// Tints, the grid of the time and the marks of events.
fn ground(sheet: &mut Sheet, report: &RunReport, frame: Frame, axis: &Axis, marks: &[Mark]) {
    let height = frame.bottom - frame.top;
    let at = |time_s: f64| time_px(report, time_s) - LEFT_PX;
    let states = report.states.iter();
    let tints = states.filter_map(|span| Some((span.from_s, span.to_s, tint(span.phase)?)));
    let gaps = report.continuity.gaps.iter();
    let gaps = gaps.map(|gap| (gap.from_s, gap.to_s, GAP));
    let upright = |sheet: &mut Sheet, class: &str, colour: Colour, places: Vec<f64>| {
        let moves = places
            .iter()
            .map(|x| format!("M{} 0v{}", px(*x), px(height)));
        let path = moves.collect::<Vec<_>>().concat();
        sheet.raw(format_args!(
            "<path class=\"{class}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"6\" \
             d=\"{path}\"/>"
        ));
    };
    zoomable(sheet, "time", frame, |sheet| {
        for (from_s, to_s, colour) in tints.chain(gaps) {
            // Short gaps are widened so that they are visible.
            let right = at(to_s).max(at(from_s) + 1.0);
            sheet.rectangle((at(from_s), 0.0), (right, height), colour);
        }
        let ticks = axis.ticks.iter().map(|(time_s, _)| at(*time_s));
        upright(sheet, "grid", GRID, ticks.collect());
        let marks = marks.iter().map(|mark| mark.at_px - LEFT_PX);
        upright(sheet, "marks", MARK, marks.collect());
    });
}

/// A legend of lines and tints, above the panels.
fn legend(report: &RunReport, panels: &[TimePanel<'_>]) -> Vec<(Sample, &'static str)> {
    let curves = panels.iter().flat_map(|panel| panel.curves);
    let drawn: Vec<&Curve> = curves.filter(|curve| curve.trace.len() > 0).collect();
    let of = |ink: Ink| drawn.iter().find(|curve| curve.ink == ink);
    let mut entries: Vec<_> = [Ink::Measured, Ink::Actual, Ink::Desired]
        .into_iter()
        .filter_map(of)
        .map(|curve| {
            let (colour, width_px) = curve.ink.pen(false);
            (Sample::Line(colour, width_px), curve.name)
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
    entries
}

/// The background of a panel while the loop was not engaged.
pub(super) fn tint(phase: Phase) -> Option<Colour> {
    match phase {
        Phase::Engaged => None,
        Phase::Standby => Some("#F0F0EE"),
        Phase::Failsafe => Some("#FBDED6"),
        Phase::Stopped => Some("#D8D8D6"),
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
