//! Measurements, set points and outputs over time.

use super::super::plots::{Panel, Plot, Scale};
use super::super::report::RunReport;
use super::axis::{Axis, extent};
use super::curves::Detail;
use super::figure::Figure;
use super::time_figure::{Kind, Refit, TimePanel, time_figure};

/// The figures of all plots of a report.
pub(super) fn figures(report: &RunReport, detail: Detail) -> Vec<Figure> {
    let plots = report.plots.iter();
    plots.map(|plot| figure(report, plot, detail)).collect()
}

/// The figure of one plot.
pub(crate) fn figure(report: &RunReport, plot: &Plot, detail: Detail) -> Figure {
    let panels = plot.panels.iter().map(|panel| TimePanel {
        height_px: panel.height_px,
        y: axis(panel, plot),
        refit: refit(panel),
        fold: panel.scale == Scale::Compass && turns_often(extent_of(panel)),
        curves: &panel.curves,
    });
    let panels: Vec<_> = panels.collect();
    let label = format!("{} over time", plot.title);
    Figure {
        title: plot.title.clone(),
        caption: plot.caption.clone(),
        svg: time_figure(report, &label, detail, &panels),
    }
}

fn refit(panel: &Panel) -> Refit {
    let (kind, least) = match panel.scale {
        _ if !panel.labels().is_empty() => (Kind::Fixed, 0.0),
        Scale::Around(least) => (Kind::Line, least),
        Scale::Together(least) => (Kind::Together, least),
        Scale::Compass if !turns_often(extent_of(panel)) => (Kind::Compass, LEAST_TURN_DEG),
        Scale::Compass | Scale::Percent => (Kind::Fixed, 0.0),
    };
    let per = 1.0;
    Refit { kind, least, per }
}

/// The least span of an axis of directions, degrees.
const LEAST_TURN_DEG: f64 = 20.0;

fn extent_of(panel: &Panel) -> (f64, f64) {
    extent(panel.curves.iter().map(|curve| &curve.trace))
}

/// Whether directions are of so many turns that each would be too small.
fn turns_often((low, high): (f64, f64)) -> bool {
    high - low > 1_080.0
}

fn axis(panel: &Panel, plot: &Plot) -> Axis {
    let title = &panel.title();
    match panel.scale {
        _ if !panel.labels().is_empty() => named(panel.labels(), title),
        Scale::Around(least) => {
            let count = (panel.height_px / 32.0) as usize;
            Axis::around(extent_of(panel), least, count, title)
        }
        Scale::Together(least) => {
            let panels = plot.panels.iter();
            let together = panels
                .filter(|other| other.scale == panel.scale)
                .flat_map(|other| &other.curves);
            let extent = extent(together.map(|curve| &curve.trace));
            Axis::around(extent, least, 3, title)
        }
        Scale::Percent => Axis::stepped((-4.0, 104.0), 25.0, title, |at| format!("{at:.0}")),
        Scale::Compass => compass(extent_of(panel), title),
    }
}

/// Letters of a name that there is room for.
const LETTERS: usize = 8;

/// A row for each of some names.
fn named(labels: &[String], title: &str) -> Axis {
    let range = (-0.5, labels.len() as f64 - 0.5);
    Axis::stepped(range, 1.0, title, |at| {
        let label = labels.get(at.round() as usize).map_or("", String::as_str);
        match label.char_indices().nth(LETTERS + 1) {
            None => label.to_owned(),
            Some(_) => label.chars().take(LETTERS).chain(['…']).collect(),
        }
    })
}

/// Directions are counted beyond full turns, so that no line jumps at north,
/// unless there are many turns; the labels are 0 to 360.
fn compass(extent: (f64, f64), title: &str) -> Axis {
    let label = |at: f64| format!("{:03.0}", at.rem_euclid(360.0).round() % 360.0 + 0.0);
    if turns_often(extent) {
        return Axis::stepped((0.0, 360.0), 90.0, title, label);
    }
    let axis = Axis::around(extent, LEAST_TURN_DEG, 5, title);
    let range = (axis.from, axis.to);
    let step = match range.1 - range.0 {
        span if span > 1_080.0 => 180.0,
        span if span > 360.0 => 90.0,
        span if span > 200.0 => 45.0,
        span if span > 90.0 => 30.0,
        span if span > 40.0 => 10.0,
        _ => 5.0,
    };
    Axis::stepped(range, step, title, label)
}
