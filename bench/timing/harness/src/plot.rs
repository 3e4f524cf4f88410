//! One plot: a panel for each load and rate, a row for each clock, lateness
//! from the median to the largest on one logarithmic scale.

use anyhow::Context as _;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::results::{Case, Results};

const PANEL_WIDTH_PX: i32 = 470;
const LEFT_PX: i32 = 150;
const RIGHT_PX: i32 = 16;
const TITLE_PX: i32 = 30;
const ROW_PX: i32 = 18;
const SCALE_PX: i32 = 26;
const TEXT_PX: i32 = 12;
/// From 10 ns to 100 ms, in powers of ten of µs.
const DECADES: std::ops::RangeInclusive<i32> = -2..=5;

const OURS: RGBColor = RGBColor(24, 66, 110);
const PEERS: RGBColor = RGBColor(150, 90, 30);
const GRID: RGBColor = RGBColor(224, 224, 224);
const WORDS: RGBColor = RGBColor(45, 45, 45);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The plot as SVG.
pub(crate) fn svg(results: &Results) -> anyhow::Result<String> {
    let cases = results.cases();
    let mut panels: Vec<Vec<&Case<'_>>> = Vec::new();
    for case in &cases {
        match panels
            .iter_mut()
            .find(|panel| (panel[0].load, panel[0].rate_hz) == (case.load, case.rate_hz))
        {
            Some(panel) => panel.push(case),
            None => panels.push(vec![case]),
        }
    }
    let mut loads: Vec<_> = panels.iter().map(|panel| panel[0].load).collect();
    loads.dedup();
    let columns = loads.len().max(1) as i32;
    let lines = panels.len() as i32 / columns + i32::from(panels.len() as i32 % columns > 0);
    let rows = panels.iter().map(Vec::len).max().unwrap_or(0) as i32;
    let panel_height = TITLE_PX + ROW_PX * rows + SCALE_PX;

    let mut text = String::new();
    {
        let size = (
            (columns * PANEL_WIDTH_PX) as u32,
            (lines * panel_height + ROW_PX) as u32,
        );
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        draw(&area, &panels, lines, panel_height).context("the plot cannot be drawn")?;
    }
    Ok(text)
}

fn draw(
    area: &Area<'_>,
    panels: &[Vec<&Case<'_>>],
    lines: i32,
    panel_height: i32,
) -> anyhow::Result<()> {
    area.fill(&WHITE)?;
    for (number, panel) in panels.iter().enumerate() {
        // Loads beside each other, rates below.
        let (column, line) = (number as i32 / lines, number as i32 % lines);
        let corner = (column * PANEL_WIDTH_PX, line * panel_height);
        draw_panel(area, corner, panel)?;
    }
    let legend = "dot: median; thick: to p99; bar: p99.9; ring: largest; medians of rounds";
    let y = lines * panel_height + ROW_PX / 2;
    area.draw_text(legend, &words(HPos::Left), (8, y))?;
    area.present()?;
    Ok(())
}

fn draw_panel(area: &Area<'_>, corner: (i32, i32), panel: &[&Case<'_>]) -> anyhow::Result<()> {
    let (left, top) = (corner.0 + LEFT_PX, corner.1 + TITLE_PX);
    let bottom = top + ROW_PX * panel.len() as i32;
    let title = format!(
        "{} Hz, {}: lateness",
        panel[0].rate_hz,
        panel[0].load.name()
    );
    area.draw_text(&title, &words(HPos::Left), (left, corner.1 + TITLE_PX / 2))?;
    for decade in DECADES {
        let x = left + along(10_f64.powi(decade));
        area.draw(&PathElement::new([(x, top), (x, bottom)], GRID))?;
        let name = decade_name(decade);
        area.draw_text(&name, &words(HPos::Center), (x, bottom + SCALE_PX / 2))?;
    }
    for (row, case) in panel.iter().enumerate() {
        let y = top + ROW_PX * row as i32 + ROW_PX / 2;
        let ink = if case.peer.is_ours() { OURS } else { PEERS };
        let late = case.spread(|figures| figures.lateness_us);
        let [p50, p99, p99_9, max] =
            [late.p50, late.p99, late.p99_9, late.max].map(|us| left + along(us));
        area.draw_text(case.peer.name(), &words(HPos::Right), (left - 8, y))?;
        area.draw(&PathElement::new([(p50, y), (max, y)], ink))?;
        area.draw(&PathElement::new([(p50, y), (p99, y)], ink.stroke_width(4)))?;
        area.draw(&PathElement::new([(p99_9, y - 5), (p99_9, y + 5)], ink))?;
        area.draw(&Circle::new((p50, y), 4, ink.filled()))?;
        area.draw(&Circle::new((max, y), 3, WHITE.filled()))?;
        area.draw(&Circle::new((max, y), 3, ink))?;
    }
    Ok(())
}

/// Position of a lateness on the scale, px from its left end; limited to the
/// ends.
fn along(us: f64) -> i32 {
    let (from, to) = (f64::from(*DECADES.start()), f64::from(*DECADES.end()));
    let share = ((us.max(f64::MIN_POSITIVE).log10() - from) / (to - from)).clamp(0.0, 1.0);
    (share * f64::from(PANEL_WIDTH_PX - LEFT_PX - RIGHT_PX)).round() as i32
}

fn decade_name(decade: i32) -> String {
    match decade {
        ..=-1 => format!("{} ns", 10_u32.pow((decade + 3).unsigned_abs())),
        0..=2 => format!("{} µs", 10_u32.pow(decade.unsigned_abs())),
        _ => format!("{} ms", 10_u32.pow((decade - 3).unsigned_abs())),
    }
}

fn words(at: HPos) -> TextStyle<'static> {
    TextStyle::from(("sans-serif", TEXT_PX).into_font())
        .pos(Pos::new(at, VPos::Center))
        .color(&WORDS)
}
