//! Percentiles of several durations, one row each, on one logarithmic scale.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::super::durations::NamedPercentiles;
use super::Figure;
use super::axis::Axis;
use super::canvas::{
    ACTUAL, Area, Drawn, LABEL_PX, PlotError, Sample, TEXT, WIDTH_PX, draw, legend, pen, px, text,
};
use super::panel::{Frame, Panel};

const LEFT_PX: f64 = 110.0;
const TOP_PX: f64 = 24.0;
const ROW_PX: f64 = 19.0;
const X_LABELS_PX: f64 = 24.0;
/// Shorter durations are drawn as this, µs: a logarithmic scale has no zero.
const LEAST_US: f64 = 0.01;

/// A row for each; `None` if all are 0.
pub(super) fn figure(
    title: &str,
    what: &str,
    rows: &[NamedPercentiles],
) -> Result<Option<Figure>, PlotError> {
    // In lockstep all ages are 0.
    if rows.iter().all(|row| row.of.max_us == 0.0) {
        return Ok(None);
    }
    let frame = Frame {
        left: LEFT_PX,
        top: TOP_PX,
        right: WIDTH_PX - 22.0,
        bottom: TOP_PX + ROW_PX * rows.len() as f64,
    };
    let svg = draw(frame.bottom + X_LABELS_PX, title, |area| {
        let all = rows.iter().map(|row| &row.of);
        let low = all.clone().map(|of| of.p50_us).fold(f64::MAX, f64::min);
        let high = all.map(|of| of.max_us).fold(0.0, f64::max);
        let x = Axis::decades((low.max(LEAST_US), high.max(LEAST_US)), "", decade);
        let y = Axis {
            from: 0.0,
            to: rows.len() as f64,
            ticks: Vec::new(),
            light: Vec::new(),
            title: String::new(),
        };
        let mut panel = Panel::new(area, frame, x, y)?;
        panel.axes(true)?;
        for (number, row) in rows.iter().enumerate() {
            draw_row(area, &mut panel, (rows.len() - number) as f64 - 0.5, row)?;
        }
        let entries = [
            (Sample::Dot(ACTUAL.filled()), "median"),
            (Sample::Line(pen(ACTUAL, 3.2)), "to p99"),
            (Sample::Upright(pen(ACTUAL, 1.0)), "p99.9"),
            (Sample::Dot(pen(ACTUAL, 1.0)), "largest"),
        ];
        legend(area, LEFT_PX, TOP_PX / 2.0 - 2.0, entries)
    })?;
    Ok(Some(Figure {
        title: title.to_owned(),
        caption: format!("{what}; the scale is logarithmic."),
        svg,
    }))
}

fn draw_row(area: &Area<'_>, panel: &mut Panel<'_>, y: f64, row: &NamedPercentiles) -> Drawn {
    let at = |us: f64| us.max(LEAST_US).log10();
    let of = &row.of;
    panel.polyline(
        vec![(at(of.p50_us), y), (at(of.max_us), y)],
        pen(ACTUAL, 0.8),
    )?;
    panel.polyline(
        vec![(at(of.p50_us), y), (at(of.p99_us), y)],
        pen(ACTUAL, 3.2),
    )?;
    let p99_9 = at(of.p99_9_us);
    panel.polyline(vec![(p99_9, y - 0.25), (p99_9, y + 0.25)], pen(ACTUAL, 1.0))?;
    panel.dot((at(of.p50_us), y), 3.2, ACTUAL.filled())?;
    panel.dot((at(of.max_us), y), 2.4, WHITE.filled())?;
    panel.dot((at(of.max_us), y), 2.4, pen(ACTUAL, 1.0))?;
    let (_, middle) = panel.on_sheet((0.0, y));
    let style = text(LABEL_PX, TEXT, HPos::Right, VPos::Center);
    area.draw_text(&row.name, &style, (px(LEFT_PX - 8.0), px(middle)))?;
    Ok(())
}

/// A power of ten of microseconds as text.
pub(super) fn decade(decade: i32) -> String {
    let (number, unit) = match decade {
        ..=-1 => (decade + 3, "ns"),
        0..=2 => (decade, "µs"),
        3..=5 => (decade - 3, "ms"),
        _ => (decade - 6, "s"),
    };
    format!("{} {unit}", 10_f64.powi(number))
}
