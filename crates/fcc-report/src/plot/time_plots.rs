//! Measurements, set points and outputs over time.

use super::super::plots::{Panel, Plot, Scale};
use super::super::report::RunReport;
use super::axis::{Axis, extent, number};
use super::curves::Detail;
use super::figure::Figure;
use super::time_figure::{TimePanel, time_figure};

/// The figures of all plots of a report.
pub(super) fn figures(report: &RunReport, detail: Detail) -> Vec<Figure> {
    let plots = report.plots.iter();
    plots.map(|plot| figure(report, plot, detail)).collect()
}

fn figure(report: &RunReport, plot: &Plot, detail: Detail) -> Figure {
    let panels = plot.panels.iter().map(|panel| TimePanel {
        height_px: panel.height_px,
        y: axis(panel, plot),
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

fn axis(panel: &Panel, plot: &Plot) -> Axis {
    let extent_of = |panel: &Panel| extent(panel.curves.iter().map(|curve| &curve.trace));
    let title = &panel.title();
    match panel.scale {
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

/// Directions are counted beyond full turns, so that no line jumps at north;
/// the labels are 0 to 360.
fn compass(extent: (f64, f64), title: &str) -> Axis {
    let label = |at: f64| format!("{:03.0}", at.rem_euclid(360.0).round() % 360.0);
    let axis = Axis::around(extent, 20.0, 5, title);
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
    // If every tick is at north, the labels count the turns.
    if step < 360.0 {
        Axis::stepped(range, step, title, label)
    } else {
        let title = title.replace('°', "turns");
        Axis::stepped(range, step, &title, |at| number(at / 360.0, 0))
    }
}
