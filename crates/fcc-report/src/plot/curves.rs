//! Lines over time as SVG paths by relative moves, which take little room: thinned to what a plot can show, and on a page also
//! in detail, for when it is zoomed.

use std::fmt::Write as _;

use super::super::plots::{Curve, Ink};
use super::super::report::RunReport;
use super::super::trace::{OVERVIEW_BINS, Point, Trace};
use super::sheet::{ACTUAL, Colour, DESIRED, MEASURED, Sheet, px};

/// Of a recording longer than this, a thin line shows more.
const DENSE_S: f64 = 600.0;

impl Ink {
    /// Colour, and width in px, by whether the plot is dense.
    pub(super) const fn pen(self, is_dense: bool) -> (Colour, f64) {
        match (self, is_dense) {
            (Self::Measured, _) => (MEASURED, 0.6),
            (Self::Actual, false) => (ACTUAL, 1.3),
            (Self::Actual, true) => (ACTUAL, 0.8),
            (Self::Desired, false) => (DESIRED, 1.0),
            (Self::Desired, true) => (DESIRED, 0.7),
        }
    }
}

/// The detail of a plot beyond its printed lines.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Detail {
    /// Nothing.
    None,
    /// Finer lines, shown when zoomed.
    WhenZoomed,
    /// The same, with this many bins per line.
    Bins(u64),
}

/// Approximate size of all finer lines of a page.
const DETAIL_BYTES: u64 = 3_000_000;
/// Approximate size of a bin of a noisy line.
const BIN_BYTES: u64 = 14;

impl Detail {
    /// Divides the size among the lines of a report.
    pub(super) fn shared_by(self, report: &RunReport) -> Self {
        if self != Self::WhenZoomed {
            return self;
        }
        let panels = report.plots.iter().flat_map(|plot| &plot.panels);
        let curves = panels.flat_map(|panel| &panel.curves);
        let traces = curves
            .map(|curve| &curve.trace)
            .chain([&report.lateness.trace]);
        let long = traces.filter(|trace| is_thinned(trace)).count();
        Self::Bins((DETAIL_BYTES / BIN_BYTES / (long as u64).max(1)).max(OVERVIEW_BINS))
    }
}

fn is_thinned(trace: &Trace) -> bool {
    trace.len() as u64 > OVERVIEW_BINS
}

/// Whether its lines are drawn thin.
pub(super) fn is_dense(report: &RunReport) -> bool {
    report.duration_s > DENSE_S
}

/// Units per pixel of the finer lines: at the largest zoom, half a pixel.
const DETAIL_PER_UNIT: i32 = 10;

/// Directions of many turns within one, and the lines broken at north.
fn folded(lines: Vec<Vec<Point>>) -> Vec<Vec<Point>> {
    let mut folded: Vec<Vec<Point>> = Vec::new();
    for line in lines {
        let mut last: Option<f64> = None;
        for Point { time_s, value } in line {
            let value = value.rem_euclid(360.0);
            let point = Point { time_s, value };
            let continues = last.is_some_and(|last| (value - last).abs() < 180.0);
            last = Some(value);
            match folded.last_mut().filter(|_| continues) {
                Some(line) => line.push(point),
                None => folded.push(vec![point]),
            }
        }
    }
    folded
}

/// Draws a curve, of directions within one turn if they `fold`; `on_panel`
/// converts a point to px.
pub(super) fn markup(
    sheet: &mut Sheet,
    curve: &Curve,
    is_dense: bool,
    fold: bool,
    detail: Detail,
    on_panel: impl Fn(Point) -> (f64, f64),
) {
    let (colour, width_px) = curve.ink.pen(is_dense);
    let dashes = match curve.ink {
        Ink::Desired => format!(" stroke-dasharray=\"{} {}\"", px(5.0), px(3.0)),
        Ink::Measured | Ink::Actual => String::new(),
    };
    let mut line = |class: &str, scale: i32, trace: &Trace| {
        let grid = |point| {
            let (x, y) = on_panel(point);
            (px(x * f64::from(scale)), px(y * f64::from(scale)))
        };
        let lines = trace.lines();
        let lines = if fold { folded(lines) } else { lines };
        let (path, width) = (path(&lines, grid), px(width_px));
        if !path.is_empty() {
            sheet.raw(format_args!(
                "<path{class} fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
                 stroke-linecap=\"round\"{dashes} d=\"{path}\"/>"
            ));
        }
    };
    let overview = curve.trace.thinned(OVERVIEW_BINS);
    match detail {
        Detail::Bins(bins) if is_thinned(&curve.trace) => {
            let scaled = format!(
                " class=\"detail\" display=\"none\" transform=\"scale({})\"",
                1.0 / f64::from(DETAIL_PER_UNIT)
            );
            line(" class=\"overview\"", 1, &overview);
            line(&scaled, DETAIL_PER_UNIT, &curve.trace.thinned(bins));
        }
        _ => line("", 1, &overview),
    }
}

/// Lines on a grid as the data of one path, by relative moves.
fn path(lines: &[Vec<Point>], grid: impl Fn(Point) -> (i32, i32)) -> String {
    let mut path = String::new();
    for line in lines {
        let mut points = line.iter().map(|point| grid(*point));
        let Some(mut at) = points.next() else {
            continue;
        };
        // A line of one point is a dot.
        let _ = write!(path, "M{} {}h0", at.0, at.1);
        let mut level = 0;
        let mut open = false;
        for (x, y) in points {
            // A value without a range can lie far outside.
            let (across, down) = (x.saturating_sub(at.0), y.saturating_sub(at.1));
            at = (x, y);
            if down == 0 {
                level = across.saturating_add(level);
                continue;
            }
            level_move(&mut path, &mut level, &mut open);
            if !std::mem::replace(&mut open, true) {
                path.push('l');
            }
            number(&mut path, across);
            number(&mut path, down);
        }
        level_move(&mut path, &mut level, &mut open);
    }
    path
}

fn level_move(path: &mut String, level: &mut i32, open: &mut bool) {
    let across = std::mem::take(level);
    if across != 0 {
        let _ = write!(path, "h{across}");
        *open = false;
    }
}

/// A number in a list: its sign separates it, too.
fn number(path: &mut String, number: i32) {
    let is_first = path.ends_with('l');
    if number >= 0 && !is_first {
        path.push(' ');
    }
    let _ = write!(path, "{number}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_past_north_begins_a_line_in_the_next_turn() {
        let line = [350.0, 355.0, 370.0, 380.0].map(|value| Point { time_s: 0.0, value });
        let values: Vec<Vec<f64>> = folded(vec![line.to_vec()])
            .iter()
            .map(|line| line.iter().map(|point| point.value).collect())
            .collect();
        assert_eq!(values, [[350.0, 355.0], [10.0, 20.0]]);
    }

    /// By the path grammar of SVG 1.1, section 8.3.
    #[test]
    fn a_line_is_a_path_of_relative_moves() {
        let line = |points: &[(f64, f64)]| {
            let point = |&(time_s, value)| Point { time_s, value };
            points.iter().map(point).collect::<Vec<_>>()
        };
        let lines = [
            line(&[(1.0, 2.0), (2.0, 2.0), (4.0, 2.0), (5.0, 7.0), (6.0, 3.0)]),
            line(&[(9.0, 9.0)]),
        ];
        let path = path(&lines, |point| (point.time_s as i32, point.value as i32));
        assert_eq!(path, "M1 2h0h3l1 5 1-4M9 9h0");
    }
}
