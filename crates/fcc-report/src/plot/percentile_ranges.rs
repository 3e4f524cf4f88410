//! Percentiles of several durations, one row each, on one logarithmic scale.

use super::super::durations::NamedPercentiles;
use super::axis::Axis;
use super::figure::Figure;
use super::panel::{Frame, Panel};
use super::sheet::{
    ACTUAL, Anchor, Dot, Font, Height, LABEL_PX, Sample, Sheet, TEXT, WHITE, WIDTH_PX,
};

const LEFT_PX: f64 = 110.0;
const TOP_PX: f64 = 24.0;
const ROW_PX: f64 = 19.0;
const X_LABELS_PX: f64 = 24.0;
/// Shorter durations are drawn as this, µs: a logarithmic scale has no zero.
const LEAST_US: f64 = 0.01;

/// A row for each; `None` if all are 0.
pub(super) fn figure(title: &str, what: &str, rows: &[NamedPercentiles]) -> Option<Figure> {
    // In lockstep all ages are 0.
    if rows.iter().all(|row| row.of.max_us == 0.0) {
        return None;
    }
    let all = rows.iter().map(|row| &row.of);
    let low = all.clone().map(|of| of.p50_us).fold(f64::MAX, f64::min);
    let high = all.map(|of| of.max_us).fold(0.0, f64::max);
    let panel = Panel {
        frame: Frame {
            left: LEFT_PX,
            top: TOP_PX,
            right: WIDTH_PX - 22.0,
            bottom: TOP_PX + ROW_PX * rows.len() as f64,
        },
        x: Axis::decades((low.max(LEAST_US), high.max(LEAST_US)), "", decade),
        y: Axis::rows(rows.len()),
    };
    let mut sheet = Sheet::default();
    panel.axes(&mut sheet, true, "");
    for (number, row) in rows.iter().enumerate() {
        draw_row(&mut sheet, &panel, (rows.len() - number) as f64 - 0.5, row);
    }
    let entries = [
        (Sample::Dot(Dot::Filled(ACTUAL)), "median"),
        (Sample::Line(ACTUAL, 3.2), "to p99"),
        (Sample::Upright(ACTUAL, 1.0), "p99.9"),
        (Sample::Dot(Dot::Open(ACTUAL, 1.0)), "largest"),
    ];
    sheet.legend((LEFT_PX, TOP_PX / 2.0 - 2.0), entries);
    Some(Figure {
        title: title.to_owned(),
        caption: format!("{what}; the scale is logarithmic."),
        svg: sheet.finish(panel.frame.bottom + X_LABELS_PX, title, &[]),
    })
}

fn draw_row(sheet: &mut Sheet, panel: &Panel, y: f64, row: &NamedPercentiles) {
    let at = |us: f64| us.max(LEAST_US).log10();
    let of = &row.of;
    let (median, largest) = ((at(of.p50_us), y), (at(of.max_us), y));
    panel.line(sheet, &[median, largest], ACTUAL, 0.8);
    panel.line(sheet, &[median, (at(of.p99_us), y)], ACTUAL, 3.2);
    let p99_9 = at(of.p99_9_us);
    panel.line(sheet, &[(p99_9, y - 0.25), (p99_9, y + 0.25)], ACTUAL, 1.0);
    panel.dot(sheet, median, 3.2, Dot::Filled(ACTUAL));
    panel.dot(sheet, largest, 2.4, Dot::Filled(WHITE));
    panel.dot(sheet, largest, 2.4, Dot::Open(ACTUAL, 1.0));
    let (_, middle) = panel.place((0.0, y));
    let font = Font(LABEL_PX, TEXT, Anchor::End, Height::Middle);
    sheet.text((LEFT_PX - 8.0, middle), &row.name, font);
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
