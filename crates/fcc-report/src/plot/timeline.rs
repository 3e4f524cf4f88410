//! The timeline of a flight: its states as a bar, and events as text below it.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::super::RunReport;
use super::super::events::EventLine;
use super::super::states::Phase;
use super::Figure;
use super::axis::Axis;
use super::canvas::{
    Area, Drawn, FAINT, LABEL_PX, PlotError, SMALL_PX, TEXT, draw, pen, px, text, text_width_px,
};
use super::time_figure::{LEFT_PX, RIGHT_PX, phase_name, time_axis, time_px};

const BAR_TOP_PX: f64 = 34.0;
const BAR_PX: f64 = 22.0;
const ROW_PX: f64 = 14.0;
/// Room between the bar and the first row of text, px.
const LEAD_PX: f64 = 10.0;
const MOST_ROWS: usize = 9;
/// At most this many events are placed.
const MOST_TRIED: usize = 80;
const MOST_LETTERS: usize = 70;

/// States and events over time.
pub(super) fn timeline(report: &RunReport) -> Result<Figure, PlotError> {
    let notes = place_notes(report);
    let rows = notes.iter().map(|note| note.row + 1).max().unwrap_or(0);
    let height_px = BAR_TOP_PX + BAR_PX + LEAD_PX + rows as f64 * ROW_PX + 6.0;
    let svg = draw(height_px, "States and events over time", |area| {
        axis(area, &time_axis(report), report)?;
        bar(area, report)?;
        for note in &notes {
            note.paint(area)?;
        }
        Ok(())
    })?;
    let caption = if notes.len() < report.event_count {
        format!(
            "States of the loop, and the {} most important of {} events; all are in the table.",
            notes.len(),
            report.event_count
        )
    } else {
        "States of the loop and events; numbers as in the plots and in the table of \
         events."
            .to_owned()
    };
    Ok(Figure {
        title: "Timeline".to_owned(),
        caption,
        svg,
    })
}

/// Above the bar: the text is below it.
fn axis(area: &Area<'_>, axis: &Axis, report: &RunReport) -> Drawn {
    let style = text(LABEL_PX, TEXT, HPos::Center, VPos::Bottom);
    for (at, label) in &axis.ticks {
        let x = px(time_px(report, *at));
        let tick = [(x, px(BAR_TOP_PX - 3.0)), (x, px(BAR_TOP_PX))];
        area.draw(&PathElement::new(tick, pen(FAINT, 0.8)))?;
        area.draw_text(label, &style, (x, px(BAR_TOP_PX - 4.0)))?;
    }
    let middle = px(f64::midpoint(LEFT_PX, RIGHT_PX));
    area.draw_text(&axis.title, &style, (middle, px(BAR_TOP_PX - 19.0)))?;
    Ok(())
}

fn bar(area: &Area<'_>, report: &RunReport) -> Drawn {
    let (top, bottom) = (px(BAR_TOP_PX), px(BAR_TOP_PX + BAR_PX));
    for span in &report.states {
        let (from, to) = (
            time_px(report, span.from_s),
            time_px(report, span.to_s).max(time_px(report, span.from_s) + 1.0),
        );
        let corners = [(px(from), top), (px(to), bottom)];
        area.draw(&Rectangle::new(corners, ink(span.phase).filled()))?;
        let name = phase_name(span.phase);
        if text_width_px(name, LABEL_PX) + 6.0 < to - from {
            let style = text(LABEL_PX, TEXT, HPos::Center, VPos::Center);
            let middle = (px(f64::midpoint(from, to)), px(BAR_TOP_PX + BAR_PX / 2.0));
            area.draw_text(name, &style, middle)?;
        }
    }
    let corners = [(px(LEFT_PX), top), (px(RIGHT_PX), bottom)];
    area.draw(&Rectangle::new(corners, pen(FAINT, 0.8)))?;
    Ok(())
}

fn ink(phase: Phase) -> RGBColor {
    match phase {
        Phase::Standby => RGBColor(232, 232, 230),
        Phase::Engaged => RGBColor(200, 219, 238),
        Phase::Failsafe => RGBColor(240, 160, 140),
        Phase::Stopped => RGBColor(190, 190, 188),
    }
}

/// Text of an event, placed.
struct Note {
    at_px: f64,
    left_px: f64,
    right_px: f64,
    row: usize,
    label: String,
}

impl Note {
    fn paint(&self, area: &Area<'_>) -> Drawn {
        let bar_bottom = BAR_TOP_PX + BAR_PX;
        let middle = bar_bottom + LEAD_PX + (self.row as f64 + 0.5) * ROW_PX;
        let x = px(self.at_px);
        let lead = [(x, px(bar_bottom)), (x, px(middle + 3.0))];
        area.draw(&PathElement::new(lead, pen(FAINT, 0.6)))?;
        let (at, side) = if self.left_px < self.at_px {
            (self.right_px, HPos::Right)
        } else {
            (self.left_px, HPos::Left)
        };
        let style = text(SMALL_PX, TEXT, side, VPos::Center);
        area.draw_text(&self.label, &style, (px(at), px(middle)))?;
        Ok(())
    }

    /// Whether neither the text nor the lead of one overlaps those of the
    /// other.
    fn is_clear_of(&self, other: &Self) -> bool {
        let crosses = |lead: &Self, label: &Self| {
            lead.row > label.row
                && (label.left_px - 2.0..=label.right_px + 2.0).contains(&lead.at_px)
        };
        let overlap = self.row == other.row
            && self.left_px < other.right_px + 8.0
            && other.left_px < self.right_px + 8.0;
        !overlap && !crosses(self, other) && !crosses(other, self)
    }
}

/// Places as many events as there is room for, the most important first, of
/// equals the latest: text is to the right of its lead, so the leads of earlier
/// events do not cross it.
fn place_notes(report: &RunReport) -> Vec<Note> {
    let mut events: Vec<&EventLine> = report.events.iter().collect();
    events.sort_by(|a, b| b.weight.cmp(&a.weight).then(b.time_s.total_cmp(&a.time_s)));
    let mut placed: Vec<Note> = Vec::new();
    for event in events.into_iter().take(MOST_TRIED) {
        let mut label = format!("{} {}", event.number, event.text);
        if label.chars().count() > MOST_LETTERS {
            label = label.chars().take(MOST_LETTERS - 1).collect();
            label.push('…');
        }
        let at_px = time_px(report, event.time_s);
        let width_px = text_width_px(&label, SMALL_PX);
        // Near the right edge the text is to the left.
        let left_px = if at_px + 4.0 + width_px > RIGHT_PX {
            at_px - 4.0 - width_px
        } else {
            at_px + 4.0
        };
        let mut note = Note {
            at_px,
            left_px,
            right_px: left_px + width_px,
            row: 0,
            label,
        };
        let room = (0..MOST_ROWS).find(|row| {
            note.row = *row;
            placed.iter().all(|other| note.is_clear_of(other))
        });
        if room.is_some() {
            placed.push(note);
        }
    }
    placed
}
