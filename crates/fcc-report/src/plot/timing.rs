//! Timing of the loop: the thesis' figures 6.1 to 6.3, the lateness, the stages
//! of a tick and the ages of measurements.

use super::super::box_plot::BoxPlot;
use super::super::report::{RunReport, Timing};
use super::super::text::time;
use super::axis::{Axis, extent};
use super::curves::Detail;
use super::figure::Figure;
use super::panel::{Frame, Panel};
use super::percentile_ranges;
use super::sheet::{
    ACTUAL, Anchor, Colour, Dot, FAINT, Font, Height, OTHER, SMALL_PX, Sheet, TEXT, WHITE,
    WIDTH_PX, text_width_px,
};
use super::time_figure::{Kind, Refit, TimePanel, time_figure};

const LEFT_PX: f64 = 90.0;
const RIGHT_PX: f64 = WIDTH_PX - 22.0;
const X_LABELS_PX: f64 = 36.0;

/// The figures that have data.
pub(super) fn figures(report: &RunReport, detail: Detail) -> Vec<Figure> {
    let Some(timing) = &report.timing else {
        return Vec::new();
    };
    let mut figures = Vec::new();
    if !timing.is_lockstep() {
        if let Some(of) = &timing.period_box_ms {
            figures.push(periods(timing, of, report.terms.run));
        }
        figures.push(lateness(timing));
        figures.push(lateness_over_time(report, detail));
    }
    figures.extend(percentile_ranges::figure(
        "Stages of a tick",
        "How long each stage took",
        &report.stages,
    ));
    figures.extend(percentile_ranges::figure(
        "Ages of measurements",
        "How old each measurement was when the loop woke",
        &report.sensor_ages,
    ));
    figures
}

fn lateness_over_time(report: &RunReport, detail: Detail) -> Figure {
    let (_, high) = extent([&report.lateness.trace]);
    let panel = TimePanel {
        height_px: 100.0,
        y: lateness_axis(high),
        fold: false,
        refit: Refit {
            kind: Kind::Line,
            least: 1.0,
            per: if high > LONG_US { 1e3 } else { 1.0 },
        },
        curves: std::slice::from_ref(&report.lateness),
    };
    Figure {
        title: "Lateness over time".to_owned(),
        caption: "From deadline to wake-up.".to_owned(),
        svg: time_figure(report, "Lateness over time", detail, &[panel]),
    }
}

/// A lateness above this is shown in ms, µs.
const LONG_US: f64 = 2_000.0;

fn lateness_axis(high: f64) -> Axis {
    let (is_long, high) = (high > LONG_US, high.max(1.0) * 1.06);
    if is_long {
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
fn periods(timing: &Timing, of: &BoxPlot, run: &str) -> Figure {
    let nominal_ms = 1e3 / timing.table.rate_hz;
    let thesis = timing.thesis.map(|thesis| (thesis.box_plot(), thesis));
    let rows = 1 + usize::from(thesis.is_some());
    let upper_px = 34.0 * rows as f64;
    let lower_top_px = 18.0 + upper_px + X_LABELS_PX + 10.0;
    let frame = |top: f64, height: f64| Frame {
        left: LEFT_PX,
        top,
        right: RIGHT_PX,
        bottom: top + height,
    };
    let (low, high) = thesis
        .iter()
        .fold((of.min, of.max), |(low, high), (thesis, _)| {
            (low.min(thesis.min), high.max(thesis.max))
        });
    let two_percent = 0.02 * nominal_ms;
    let range = (
        low.min(nominal_ms - 1.5 * two_percent),
        high.max(nominal_ms + 1.5 * two_percent),
    );
    let mut sheet = Sheet::default();
    let panel = Panel {
        frame: frame(18.0, upper_px),
        x: Axis::around(range, 0.0, 10, "period, ms"),
        y: Axis::rows(rows),
    };
    let band = (nominal_ms - two_percent, nominal_ms + two_percent);
    panel.fill(&mut sheet, (band.0, 0.0), (band.1, rows as f64), "#E2EEE2");
    panel.axes(&mut sheet, true, "");
    let (middle, top) = panel.place((nominal_ms, rows as f64));
    let font = Font(SMALL_PX, FAINT, Anchor::Middle, Height::Bottom);
    sheet.text((middle, top - 2.0), "±2 %", font);
    let mut draw_row = |row: usize, of: &BoxPlot, mean, name: &str, ink| {
        let y = (rows - row) as f64 - 0.5;
        draw_box(&mut sheet, &panel, y, of, mean, ink);
        let (_, at) = panel.place((nominal_ms, y));
        let font = Font(SMALL_PX, TEXT, Anchor::End, Height::Middle);
        sheet.text((LEFT_PX - 8.0, at), name, font);
    };
    let mean_ms = timing.table.period_ms.mean;
    draw_row(0, of, mean_ms, &format!("this {run}"), ACTUAL);
    if let Some((of, thesis)) = &thesis {
        draw_row(1, of, thesis.mean_ms, "thesis (2012)", OTHER);
    }
    let deviation = of.deviation_from(nominal_ms, 1e3);
    let whiskers = (deviation.whisker_low, deviation.whisker_high);
    let beyond = 0.5 * (whiskers.1 - whiskers.0);
    let panel = Panel {
        frame: frame(lower_top_px, 40.0),
        x: Axis::around(
            (whiskers.0 - beyond, whiskers.1 + beyond),
            0.1,
            10,
            &format!("this {run}: period less {nominal_ms:.3} ms, µs"),
        ),
        y: Axis::rows(1),
    };
    panel.axes(&mut sheet, true, "");
    let mean_us = (mean_ms - nominal_ms) * 1e3;
    draw_box(&mut sheet, &panel, 0.5, &deviation, mean_us, ACTUAL);
    let beside = if timing.thesis.is_some() {
        " Above on one scale with the thesis, whose box is from its text and whose \
         whiskers reach its extremes; below by itself, as far as its whiskers and half \
         as far again."
    } else {
        ""
    };
    let height_px = lower_top_px + 40.0 + X_LABELS_PX;
    Figure {
        title: "Period of the loop".to_owned(),
        caption: format!(
            "Box: the middle half; line: median; dot: mean; whiskers: to the last period \
             within 1.5 box lengths; circles: the {} beyond (thesis, figures 6.1 to 6.3).{beside}",
            of.outlier_count
        ),
        svg: sheet.finish(height_px, "Box plot of the period", &[]),
    }
}

/// A box around `y`, from 0.28 below to 0.28 above.
fn draw_box(sheet: &mut Sheet, panel: &Panel, y: f64, of: &BoxPlot, mean: f64, ink: Colour) {
    const HALF: f64 = 0.28;
    let mut last_px = f64::NEG_INFINITY;
    for outlier in &of.outliers {
        // Equal values are drawn once.
        let (at_px, _) = panel.place((*outlier, y));
        if panel.shows(*outlier) && at_px - last_px >= 0.8 {
            last_px = at_px;
            panel.dot(sheet, (*outlier, y), 2.0, Dot::Open(ink, 0.7));
        }
    }
    let (low, high) = (y - HALF, y + HALF);
    let (q1, q3) = (of.q1, of.q3);
    panel.fill(sheet, (q1, low), (q3, high), WHITE);
    let mut line = |points: &[(f64, f64)]| panel.line(sheet, points, ink, 1.1);
    line(&[(of.whisker_low, y), (q1, y)]);
    line(&[(q3, y), (of.whisker_high, y)]);
    for end in [of.whisker_low, of.whisker_high] {
        line(&[(end, y - HALF / 2.0), (end, y + HALF / 2.0)]);
    }
    line(&[(q1, low), (q3, low), (q3, high), (q1, high), (q1, low)]);
    panel.line(sheet, &[(of.median, low), (of.median, high)], ink, 2.0);
    if panel.shows(mean) {
        panel.dot(sheet, (mean, y), 2.2, Dot::Filled(ink));
    }
}

/// Both axes are logarithmic: one late tick in a million is visible.
fn lateness(timing: &Timing) -> Figure {
    const ROWS: usize = 4;
    const ROW_PX: f64 = 12.0;
    let bins = &timing.lateness_histogram;
    let range = (
        bins.first().map_or(1.0, |bin| bin.from_us),
        bins.last().map_or(10.0, |bin| bin.to_us),
    );
    let most = bins.iter().map(|bin| bin.count).max().unwrap_or(1);
    let top_px = ROWS as f64 * ROW_PX + 4.0;
    let mut y = Axis::decades((1.0, most as f64), "ticks", |decade| {
        format!("{}", 10_u64.saturating_pow(decade.unsigned_abs()))
    });
    // A bin of one tick has a height, too.
    y.from = 0.5_f64.log10();
    y.to = y.to.min((most as f64).log10() + 0.25).max(0.5);
    y.ticks.retain(|(at, _)| *at <= y.to);
    y.light.retain(|at| *at <= y.to);
    let (floor, ceiling) = (y.from, y.to);
    let panel = Panel {
        frame: Frame {
            left: 60.0,
            top: top_px,
            right: RIGHT_PX,
            bottom: top_px + 170.0,
        },
        x: Axis::decades(range, "lateness", percentile_ranges::decade),
        y,
    };
    let mut sheet = Sheet::default();
    panel.axes(&mut sheet, true, "");
    for bin in bins.iter().filter(|bin| bin.count > 0) {
        let (from, to) = (bin.from_us.log10(), bin.to_us.log10());
        let inset = 0.04 * (to - from);
        let top = (to - inset, (bin.count as f64).log10());
        panel.fill(&mut sheet, (from + inset, floor), top, "#7896B9");
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
        let (x, bottom) = panel.place((at, floor));
        let (_, top) = panel.place((at, ceiling));
        // Text ends at its line: later lines are to the right of it.
        let left = x - 3.0 - text_width_px(&label, SMALL_PX);
        let row = ends.iter().position(|end| left > end + 6.0);
        let row = row.unwrap_or(ROWS - 1);
        if let Some(end) = ends.get_mut(row) {
            *end = x;
        }
        let y = top_px - 2.0 - (row + 1) as f64 * ROW_PX;
        sheet.line(&[(x, bottom), (x, top.min(y))], TEXT, 0.7);
        let font = Font(SMALL_PX, TEXT, Anchor::End, Height::Top);
        sheet.text((x - 3.0, y), &label, font);
    }
    Figure {
        title: "Lateness".to_owned(),
        caption: "How late the loop woke after its deadlines: ticks in bins of a tenth of a \
                  decade; both scales are logarithmic."
            .to_owned(),
        svg: sheet.finish(
            panel.frame.bottom + X_LABELS_PX,
            "Histogram of the lateness",
            &[],
        ),
    }
}
