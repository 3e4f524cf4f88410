//! Plots over time, one panel above another.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::super::RunReport;
use super::super::plots::Curve;
use super::super::states::Phase;
use super::axis::Axis;
use super::canvas::{
    Area, Drawn, FAINT, LABEL_PX, PlotError, SMALL_PX, TEXT, WIDTH_PX, draw, pen, px, text,
    text_width_px,
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
    let marks = marks(&report.events, |time_s| time_px(report, time_s));
    let mut svg = draw(bottom + X_LABELS_PX, label, |area| {
        legend(area, report, panels)?;
        for (panel, frame) in panels.iter().zip(&frames) {
            let is_last = frame.bottom == bottom;
            draw_panel(area, report, panel, *frame, is_last, &marks)?;
        }
        number_marks(area, top, &marks)
    })?;
    let curves = |(panel, frame): (&TimePanel<'_>, &Frame)| -> String {
        let (y, frame) = (panel.y.clone(), *frame);
        let curves = panel.curves.iter();
        curves
            .map(|curve| {
                markup(curve, is_dense(report), detail, |point| {
                    let share = (point.value - y.from) / (y.to - y.from);
                    let height = frame.bottom - frame.top;
                    (time_px(report, point.time_s), frame.bottom - share * height)
                })
            })
            .collect()
    };
    let lines: String = panels.iter().zip(&frames).map(curves).collect();
    let end = svg.rfind("</svg>").unwrap_or(svg.len());
    svg.insert_str(end, &lines);
    // For the page's script: the position of the time axis.
    let (left, right, end_s) = (px(LEFT_PX), px(RIGHT_PX), end_s(report));
    let axis = format!(" data-left=\"{left}\" data-right=\"{right}\" data-end=\"{end_s}\"");
    svg.insert_str("<svg".len(), &axis);
    Ok(svg)
}

fn draw_panel(
    area: &Area<'_>,
    report: &RunReport,
    panel: &TimePanel<'_>,
    frame: Frame,
    is_last: bool,
    marks: &[Mark],
) -> Drawn {
    let mut drawn = Panel::new(area, frame, time_axis(report), panel.y.clone())?;
    for span in &report.states {
        if let Some(tint) = tint(span.phase) {
            drawn.tint(span.from_s, span.to_s, tint)?;
        }
    }
    for gap in &report.continuity.gaps {
        // Short gaps are widened so that they are visible.
        let least_s = report.duration_s / (RIGHT_PX - LEFT_PX);
        drawn.tint(gap.from_s, gap.to_s.max(gap.from_s + least_s), GAP)?;
    }
    drawn.axes(is_last)?;
    for mark in marks {
        let (x, top, bottom) = (px(mark.at_px), px(frame.top), px(frame.bottom));
        area.draw(&PathElement::new(
            [(x, top), (x, bottom)],
            pen(RGBColor(190, 190, 190), 0.6),
        ))?;
    }
    Ok(())
}

fn number_marks(area: &Area<'_>, top: f64, marks: &[Mark]) -> Drawn {
    let style = text(SMALL_PX, FAINT, HPos::Center, VPos::Bottom);
    for mark in marks {
        area.draw_text(&mark.label(), &style, (px(mark.at_px), px(top - 1.0)))?;
    }
    Ok(())
}

/// A legend of lines and tints, above the panels.
fn legend(area: &Area<'_>, report: &RunReport, panels: &[TimePanel<'_>]) -> Drawn {
    let curves = panels.iter().flat_map(|panel| panel.curves);
    let drawn: Vec<&Curve> = curves.filter(|curve| curve.trace.len() > 0).collect();
    let of = |ink: Ink| drawn.iter().find(|curve| curve.ink == ink);
    let mut inks: Vec<_> = [Ink::Measured, Ink::Actual, Ink::Desired]
        .into_iter()
        .filter_map(of)
        .collect();
    // One line needs no name.
    if inks.len() == 1 {
        inks.clear();
    }
    let in_phase = |phase: Phase| report.states.iter().any(|span| span.phase == phase);
    let mut x = LEFT_PX;
    let middle = LEGEND_PX / 2.0 - 1.0;
    let style = text(LABEL_PX, TEXT, HPos::Left, VPos::Center);
    let mut add = |sample: &dyn Fn(f64) -> Drawn, label: &str| -> Drawn {
        sample(x)?;
        area.draw_text(label, &style, (px(x + 26.0), px(middle)))?;
        x += 26.0 + text_width_px(label, LABEL_PX) + 16.0;
        Ok(())
    };
    for curve in inks {
        let (colour, width_px) = curve.ink.pen(false);
        let sample = |x: f64| -> Drawn {
            let ends = [(px(x), px(middle)), (px(x + 21.0), px(middle))];
            Ok(area.draw(&PathElement::new(ends, pen(colour, width_px)))?)
        };
        add(&sample, curve.name)?;
    }
    let tints = [Phase::Standby, Phase::Failsafe, Phase::Stopped]
        .into_iter()
        .filter(|phase| in_phase(*phase))
        .filter_map(|phase| Some((tint(phase)?, phase_name(phase))))
        .chain((report.continuity.lost > 0).then_some((GAP, "records missing")));
    for (tint, label) in tints {
        let sample = |x: f64| -> Drawn {
            let corners = [
                (px(x + 5.0), px(middle - 5.0)),
                (px(x + 21.0), px(middle + 5.0)),
            ];
            area.draw(&Rectangle::new(corners, tint.filled()))?;
            Ok(())
        };
        add(&sample, label)?;
    }
    Ok(())
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
    let end_s = end_s(report);
    let (unit_s, unit) = match end_s {
        end_s if end_s <= 300.0 => (1.0, "s"),
        end_s if end_s <= 10_800.0 => (60.0, "min"),
        _ => (3_600.0, "h"),
    };
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
