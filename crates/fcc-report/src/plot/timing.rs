//! Timing of the loop: the thesis' figures 6.1 to 6.3, the lateness, the stages
//! of a tick and the ages of measurements.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::super::box_plot::BoxPlot;
use super::super::text::time;
use super::super::{RunReport, Timing};
use super::axis::{Axis, extent};
use super::canvas::{
    ACTUAL, Drawn, FAINT, OTHER, PlotError, SMALL_PX, TEXT, WIDTH_PX, draw, pen, px, text,
    text_width_px,
};
use super::curves::Detail;
use super::panel::{Frame, Panel};
use super::time_figure::{TimePanel, time_figure};
use super::{Figure, percentile_ranges};

const LEFT_PX: f64 = 90.0;
const RIGHT_PX: f64 = WIDTH_PX - 22.0;
const X_LABELS_PX: f64 = 36.0;

/// The figures that have data.
pub(super) fn figures(report: &RunReport, detail: Detail) -> Result<Vec<Figure>, PlotError> {
    let Some(timing) = &report.timing else {
        return Ok(Vec::new());
    };
    let mut figures = Vec::new();
    if !timing.is_lockstep() {
        if let Some(of) = &timing.period_box_ms {
            figures.push(periods(timing, of, report.terms.run)?);
        }
        figures.push(lateness(timing)?);
        figures.push(lateness_over_time(report, detail)?);
    }
    figures.extend(percentile_ranges::figure(
        "Stages of a tick",
        "How long each stage took",
        &report.stages,
    )?);
    figures.extend(percentile_ranges::figure(
        "Ages of measurements",
        "How old each measurement was when the loop woke",
        &report.sensor_ages,
    )?);
    Ok(figures)
}

fn lateness_over_time(report: &RunReport, detail: Detail) -> Result<Figure, PlotError> {
    Ok(Figure {
        title: "Lateness over time".to_owned(),
        caption: "From deadline to wake-up.".to_owned(),
        svg: time_figure(
            report,
            "Lateness over time",
            detail,
            &[TimePanel {
                height_px: 100.0,
                y: lateness_axis(extent([&report.lateness.trace])),
                curves: std::slice::from_ref(&report.lateness),
            }],
        )?,
    })
}

fn lateness_axis((_, high): (f64, f64)) -> Axis {
    let high = high.max(1.0) * 1.06;
    if high > 2_000.0 {
        let mut axis = Axis::exactly((0.0, high / 1e3), 3, "lateness, ms");
        axis.to = high;
        for (at, _) in &mut axis.ticks {
            *at *= 1e3;
        }
        axis
    } else {
        Axis::exactly((0.0, high), 3, "lateness, µs")
    }
}

/// The periods next to the thesis', and below them alone.
fn periods(timing: &Timing, of: &BoxPlot, run: &str) -> Result<Figure, PlotError> {
    let nominal_ms = 1e3 / timing.table.rate_hz;
    let thesis = timing.thesis.map(|thesis| thesis.box_plot());
    let rows = 1 + usize::from(thesis.is_some());
    let upper_px = 34.0 * rows as f64;
    let lower_top_px = 18.0 + upper_px + X_LABELS_PX + 10.0;
    let svg = draw(
        lower_top_px + 40.0 + X_LABELS_PX,
        "Box plot of the period",
        |area| {
            let (low, high) = thesis.iter().fold((of.min, of.max), |(low, high), thesis| {
                (low.min(thesis.min), high.max(thesis.max))
            });
            let two_percent = 0.02 * nominal_ms;
            let range = (
                low.min(nominal_ms - 1.5 * two_percent),
                high.max(nominal_ms + 1.5 * two_percent),
            );
            let frame = |top: f64, height: f64| Frame {
                left: LEFT_PX,
                top,
                right: RIGHT_PX,
                bottom: top + height,
            };
            let x = Axis::around(range, 0.0, 10, "period, ms");
            let mut panel = Panel::new(area, frame(18.0, upper_px), x, rows_axis(rows))?;
            let band = RGBColor(226, 238, 226);
            panel.tint(nominal_ms - two_percent, nominal_ms + two_percent, band)?;
            panel.axes(true)?;
            let style = text(SMALL_PX, FAINT, HPos::Center, VPos::Bottom);
            let (middle, top) = panel.on_sheet((nominal_ms, rows as f64));
            area.draw_text("±2 %", &style, (px(middle), px(top - 2.0)))?;
            let draw_row =
                |panel: &mut Panel<'_>, row: usize, of: &BoxPlot, mean, name: &str, ink| {
                    let y = (rows - row) as f64 - 0.5;
                    draw_box(panel, y, of, mean, ink)?;
                    let (_, at) = panel.on_sheet((nominal_ms, y));
                    let style = text(SMALL_PX, TEXT, HPos::Right, VPos::Center);
                    area.draw_text(name, &style, (px(LEFT_PX - 8.0), px(at)))
                        .map_err(PlotError::from)
                };
            let mean_ms = timing.table.period_ms.mean;
            draw_row(&mut panel, 0, of, mean_ms, &format!("this {run}"), ACTUAL)?;
            if let (Some(of), Some(thesis)) = (&thesis, &timing.thesis) {
                draw_row(&mut panel, 1, of, thesis.mean_ms, "thesis (2012)", OTHER)?;
            }
            let deviation = of.deviation_from(nominal_ms, 1e3);
            let whiskers = (deviation.whisker_low, deviation.whisker_high);
            let beyond = 0.5 * (whiskers.1 - whiskers.0);
            let x = Axis::around(
                (whiskers.0 - beyond, whiskers.1 + beyond),
                0.1,
                10,
                &format!("this {run}: period less {nominal_ms:.3} ms, µs"),
            );
            let mut panel = Panel::new(area, frame(lower_top_px, 40.0), x, rows_axis(1))?;
            panel.axes(true)?;
            let mean_us = (mean_ms - nominal_ms) * 1e3;
            draw_box(&mut panel, 0.5, &deviation, mean_us, ACTUAL)
        },
    )?;
    let beside = if timing.thesis.is_some() {
        " Above on one scale with the thesis, whose box is from its text and whose \
         whiskers reach its extremes; below by itself, as far as its whiskers and half \
         as far again."
    } else {
        ""
    };
    Ok(Figure {
        title: "Period of the loop".to_owned(),
        caption: format!(
            "Box: the middle half; line: median; dot: mean; whiskers: to the last period \
             within 1.5 box lengths; circles: the {} beyond (thesis, figures 6.1 to 6.3).{beside}",
            of.outlier_count
        ),
        svg,
    })
}

fn rows_axis(rows: usize) -> Axis {
    Axis {
        from: 0.0,
        to: rows as f64,
        ticks: Vec::new(),
        light: Vec::new(),
        title: String::new(),
    }
}

/// A box around `y`, from 0.28 below to 0.28 above.
fn draw_box(panel: &mut Panel<'_>, y: f64, of: &BoxPlot, mean: f64, ink: RGBColor) -> Drawn {
    const HALF: f64 = 0.28;
    let line = pen(ink, 1.1);
    let mut last_px = f64::NEG_INFINITY;
    for outlier in &of.outliers {
        // Equal values are drawn once.
        let (at_px, _) = panel.on_sheet((*outlier, y));
        if panel.shows(*outlier) && at_px - last_px >= 0.8 {
            last_px = at_px;
            panel.dot((*outlier, y), 2.0, pen(ink, 0.7))?;
        }
    }
    panel.polyline(vec![(of.whisker_low, y), (of.q1, y)], line)?;
    panel.polyline(vec![(of.q3, y), (of.whisker_high, y)], line)?;
    for end in [of.whisker_low, of.whisker_high] {
        panel.polyline(vec![(end, y - HALF / 2.0), (end, y + HALF / 2.0)], line)?;
    }
    let (low, high) = (y - HALF, y + HALF);
    panel.bar((of.q1, low), (of.q3, high), WHITE.filled())?;
    let corners = vec![
        (of.q1, low),
        (of.q3, low),
        (of.q3, high),
        (of.q1, high),
        (of.q1, low),
    ];
    panel.polyline(corners, line)?;
    panel.polyline(vec![(of.median, low), (of.median, high)], pen(ink, 2.0))?;
    if panel.shows(mean) {
        panel.dot((mean, y), 2.2, ink.filled())?;
    }
    Ok(())
}

/// Both axes are logarithmic: one late tick in a million is visible.
fn lateness(timing: &Timing) -> Result<Figure, PlotError> {
    const ROWS: usize = 4;
    const ROW_PX: f64 = 12.0;
    let bins = &timing.lateness_histogram;
    let range = (
        bins.first().map_or(1.0, |bin| bin.from_us),
        bins.last().map_or(10.0, |bin| bin.to_us),
    );
    let most = bins.iter().map(|bin| bin.count).max().unwrap_or(1);
    let top_px = ROWS as f64 * ROW_PX + 4.0;
    let frame = Frame {
        left: 60.0,
        top: top_px,
        right: RIGHT_PX,
        bottom: top_px + 170.0,
    };
    let svg = draw(
        frame.bottom + X_LABELS_PX,
        "Histogram of the lateness",
        |area| {
            let x = Axis::decades(range, "lateness", percentile_ranges::decade);
            let mut y = Axis::decades((1.0, most as f64), "ticks", |decade| {
                format!("{}", 10_u64.saturating_pow(decade.unsigned_abs()))
            });
            // A bin of one tick has a height, too.
            y.from = 0.5_f64.log10();
            y.to = y.to.min((most as f64).log10() + 0.25).max(0.5);
            y.ticks.retain(|(at, _)| *at <= y.to);
            y.light.retain(|at| *at <= y.to);
            let floor = y.from;
            let ceiling = y.to;
            let mut panel = Panel::new(area, frame, x, y)?;
            panel.axes(true)?;
            for bin in bins.iter().filter(|bin| bin.count > 0) {
                let (from, to) = (bin.from_us.log10(), bin.to_us.log10());
                let inset = 0.04 * (to - from);
                panel.bar(
                    (from + inset, floor),
                    (to - inset, (bin.count as f64).log10()),
                    RGBColor(120, 150, 185).filled(),
                )?;
            }
            let of = &timing.table.lateness_us;
            let mut ends = [f64::NEG_INFINITY; ROWS];
            for (name, us) in [
                ("p50", of.p50),
                ("p99", of.p99),
                ("p99.9", of.p99_9),
                ("max", of.max),
            ] {
                let label = format!("{name} {}", time(us));
                let at = us.max(0.1).log10();
                let (x, bottom) = panel.on_sheet((at, floor));
                let (_, top) = panel.on_sheet((at, ceiling));
                // Text ends at its line: later lines are to the right of it.
                let left = x - 3.0 - text_width_px(&label, SMALL_PX);
                let row = ends.iter().position(|end| left > end + 6.0);
                let row = row.unwrap_or(ROWS - 1);
                if let Some(end) = ends.get_mut(row) {
                    *end = x;
                }
                let y = top_px - 2.0 - (row + 1) as f64 * ROW_PX;
                area.draw(&PathElement::new(
                    [(px(x), px(bottom)), (px(x), px(top.min(y)))],
                    pen(TEXT, 0.7),
                ))?;
                let style = text(SMALL_PX, TEXT, HPos::Right, VPos::Top);
                area.draw_text(&label, &style, (px(x - 3.0), px(y)))?;
            }
            Ok(())
        },
    )?;
    Ok(Figure {
        title: "Lateness".to_owned(),
        caption: "How late the loop woke after its deadlines: ticks in bins of a tenth of a \
                  decade; both scales are logarithmic."
            .to_owned(),
        svg,
    })
}
