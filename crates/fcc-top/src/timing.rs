//! The lateness of the loop.

use std::fmt::Write as _;

use fcc_live::{LATENESS_BOUNDS_NS, LatenessCounts, Status};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style, Stylize};
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use super::picture::Picture;
use fcc_telemetry::Telemetry;

/// Draws the percentiles of the whole run and, below them, a histogram of the
/// lateness: both scales are logarithmic, so that a few late ticks are visible.
pub(super) fn draw<C: Telemetry>(frame: &mut Frame<'_>, area: Rect, picture: &Picture<C>) {
    let Some(status) = &picture.status else {
        frame.render_widget(Paragraph::new("each second; not yet"), area);
        return;
    };
    let [figures, histogram] =
        Layout::vertical([Constraint::Length(4), Constraint::Fill(1)]).areas(area);
    frame.render_widget(Paragraph::new(lines(status, picture)), figures);
    draw_histogram(frame, histogram, &status.lateness_counts);
}

fn lines<C: Telemetry>(status: &Status, picture: &Picture<C>) -> Vec<Line<'static>> {
    let figure = |name: &'static str, ns: u64| {
        [
            format!("{name:<6}").dim(),
            format!("{:<8}", duration(ns)).bold(),
        ]
    };
    let record = picture.record.as_ref();
    let lost = record.map_or(0, |record| record.records_dropped);
    let faults = page_faults(record.map_or(0, |record| record.page_faults));
    let early = match record.map_or(0, |record| record.early_wake_ns) {
        0 => ["early ".dim(), "off".into()],
        early_ns => figure("early", early_ns),
    };
    let missed = count("missed", status.missed);
    let dropped = count("lost", lost);
    vec![
        Line::from_iter(
            [
                figure("p50", status.lateness_p50_ns),
                figure("p99", status.lateness_p99_ns),
            ]
            .concat(),
        ),
        Line::from_iter(
            [
                figure("p99.9", status.lateness_p99_9_ns),
                figure("max", status.lateness_max_ns),
            ]
            .concat(),
        ),
        Line::from_iter([missed, dropped].concat()),
        Line::from_iter([faults, early].concat()),
    ]
}

/// A count that should be 0.
fn count(name: &'static str, number: u64) -> [Span<'static>; 2] {
    [
        format!("{name:<6} ").dim(),
        graded(format!("{number:<8}"), number),
    ]
}

/// The name takes the room of a large count.
fn page_faults(number: u64) -> [Span<'static>; 2] {
    ["page faults ".dim(), graded(format!("{number:<3}"), number)]
}

fn graded(text: String, number: u64) -> Span<'static> {
    if number == 0 {
        text.green()
    } else {
        text.red().bold()
    }
}

/// Times in three figures: `850 ns`, `12.3 µs`, `1.20 ms`.
pub(super) fn duration(ns: u64) -> String {
    let ns = ns as f64;
    let (number, unit) = if ns < 1e3 {
        return format!("{ns:.0} ns");
    } else if ns < 1e6 {
        (ns / 1e3, "µs")
    } else if ns < 1e9 {
        (ns / 1e6, "ms")
    } else {
        (ns / 1e9, "s")
    };
    // The bounds at which rounding gives a further digit.
    let digits = match number {
        ..9.995 => 2,
        9.995..99.95 => 1,
        _ => 0,
    };
    format!("{number:.digits$} {unit}")
}

/// Eighths of a character, from none to all of it.
const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

fn draw_histogram(frame: &mut Frame<'_>, area: Rect, counts: &LatenessCounts) {
    let rows = area.height.saturating_sub(1);
    let bin = (area.width / counts.len() as u16).max(1);
    // The scale ends at a power of ten, so that it does not change each second.
    let decades = (counts.iter().max().copied().unwrap_or(0).max(9) as f64 + 1.0)
        .log10()
        .ceil();
    let mut lines: Vec<Line<'static>> = (0..rows)
        .map(|row| {
            let below = f64::from(rows - 1 - row) * 8.0;
            counts
                .iter()
                .enumerate()
                .map(|(n, count)| {
                    let all = f64::from(rows) * 8.0;
                    // A single tick is visible, too.
                    let height = if *count == 0 {
                        0.0
                    } else {
                        ((*count as f64 + 1.0).log10() / decades * all).max(1.0)
                    };
                    let eighths = (height - below).clamp(0.0, 8.0).round() as usize;
                    let letter = EIGHTHS.get(eighths).copied().unwrap_or(' ');
                    Span::styled(
                        letter.to_string().repeat(usize::from(bin)),
                        Style::new().fg(color(n)),
                    )
                })
                .collect()
        })
        .collect();
    lines.push(scale(usize::from(bin)).dim());
    frame.render_widget(Paragraph::new(lines), area);
}

/// Green up to 100 µs, yellow up to 1 ms, red beyond.
fn color(bin: usize) -> Color {
    match LATENESS_BOUNDS_NS.get(bin) {
        Some(bound) if *bound <= 100_000 => Color::Green,
        Some(bound) if *bound <= 1_000_000 => Color::Yellow,
        _ => Color::Red,
    }
}

/// Every second decade, under the edge between its bins.
fn scale(bin: usize) -> Line<'static> {
    let mut text = String::new();
    let mut column = 0;
    // Bin 0 ends at 100 ns, and each decade has two.
    for (decade, word) in [(1, "1µs┘"), (3, "100µs┘"), (5, "10ms┘")] {
        let end = bin * (1 + 2 * decade);
        let room = end - column;
        let _ = write!(text, "{word:>room$}");
        column = end;
    }
    Line::from(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_three_figures() {
        for (ns, text) in [
            (0, "0 ns"),
            (999, "999 ns"),
            (1_000, "1.00 µs"),
            (9_996, "10.0 µs"),
            (99_960, "100 µs"),
            (12_345_678, "12.3 ms"),
            (2_500_000_000, "2.50 s"),
        ] {
            assert_eq!(duration(ns), text);
        }
    }
}
