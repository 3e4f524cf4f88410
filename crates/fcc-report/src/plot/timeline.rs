//! The timeline of a flight: its states as a bar, and events as text below it.

use std::cmp::Reverse;

use super::super::events::EventLine;
use super::super::report::RunReport;
use super::super::states::Phase;
use super::axis::Axis;
use super::figure::Figure;
use super::sheet::{
    Anchor, Colour, FAINT, Font, Height, LABEL_PX, SMALL_PX, Sheet, TEXT, text_width_px,
};
use super::time_figure::{LEFT_PX, RIGHT_PX, phase_name, time_axis, time_px};

const BAR_TOP_PX: f64 = 34.0;
const BAR_PX: f64 = 22.0;
const ROW_PX: f64 = 14.0;
/// Room between the bar and the first row of text, px.
const LEAD_PX: f64 = 10.0;
const MOST_ROWS: usize = 9;
/// Events that are less than this apart are listed together, px.
const CROWD_PX: f64 = 4.0;
/// At most this many lists of events are placed.
const MOST_TRIED: usize = 80;
const MOST_LETTERS: usize = 70;

/// States and events over time.
pub(super) fn timeline(report: &RunReport) -> Figure {
    let notes = place_notes(report);
    let rows = notes.iter().map(|note| note.row + 1).max().unwrap_or(0);
    let height_px = BAR_TOP_PX + BAR_PX + LEAD_PX + rows as f64 * ROW_PX + 6.0;
    let mut sheet = Sheet::default();
    axis(&mut sheet, &time_axis(report), report);
    bar(&mut sheet, report);
    for note in &notes {
        note.paint(&mut sheet);
    }
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
    Figure {
        title: "Timeline".to_owned(),
        caption,
        svg: sheet.finish(height_px, "States and events over time", &[]),
    }
}

/// Above the bar: the text is below it.
fn axis(sheet: &mut Sheet, axis: &Axis, report: &RunReport) {
    let font = Font(LABEL_PX, TEXT, Anchor::Middle, Height::Bottom);
    for (at, label) in &axis.ticks {
        let x = time_px(report, *at);
        sheet.line(&[(x, BAR_TOP_PX - 3.0), (x, BAR_TOP_PX)], FAINT, 0.8);
        sheet.text((x, BAR_TOP_PX - 4.0), label, font);
    }
    let middle = f64::midpoint(LEFT_PX, RIGHT_PX);
    sheet.text((middle, BAR_TOP_PX - 19.0), &axis.title, font);
}

fn bar(sheet: &mut Sheet, report: &RunReport) {
    let (top, bottom) = (BAR_TOP_PX, BAR_TOP_PX + BAR_PX);
    for span in &report.states {
        let from = time_px(report, span.from_s);
        let to = time_px(report, span.to_s).max(from + 1.0);
        sheet.rectangle((from, top), (to, bottom), ink(span.phase));
        let name = phase_name(span.phase);
        if text_width_px(name, LABEL_PX) + 6.0 < to - from {
            let middle = (f64::midpoint(from, to), f64::midpoint(top, bottom));
            let font = Font(LABEL_PX, TEXT, Anchor::Middle, Height::Middle);
            sheet.text(middle, name, font);
        }
    }
    let (left, right) = (LEFT_PX, RIGHT_PX);
    let outline = [
        (left, top),
        (right, top),
        (right, bottom),
        (left, bottom),
        (left, top),
    ];
    sheet.line(&outline, FAINT, 0.8);
}

fn ink(phase: Phase) -> Colour {
    match phase {
        Phase::Standby => "#E8E8E6",
        Phase::Engaged => "#C8DBEE",
        Phase::Failsafe => "#F0A08C",
        Phase::Stopped => "#BEBEBC",
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
    fn paint(&self, sheet: &mut Sheet) {
        let bar_bottom = BAR_TOP_PX + BAR_PX;
        let middle = bar_bottom + LEAD_PX + (self.row as f64 + 0.5) * ROW_PX;
        let x = self.at_px;
        sheet.line(&[(x, bar_bottom), (x, middle + 3.0)], FAINT, 0.6);
        let (at, side) = if self.left_px < x {
            (self.right_px, Anchor::End)
        } else {
            (self.left_px, Anchor::Start)
        };
        let font = Font(SMALL_PX, TEXT, side, Height::Middle);
        sheet.text((at, middle), &self.label, font);
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
/// events do not cross it. Events at one place are a list in their order.
fn place_notes(report: &RunReport) -> Vec<Note> {
    let mut crowds: Vec<(f64, Vec<&EventLine>)> = Vec::new();
    for event in &report.events {
        let at_px = time_px(report, event.time_s);
        match crowds.last_mut() {
            Some((first_px, crowd)) if at_px - *first_px < CROWD_PX => crowd.push(event),
            _ => crowds.push((at_px, vec![event])),
        }
    }
    let weight = |crowd: &[&EventLine]| crowd.iter().map(|event| event.weight).max();
    crowds.sort_by(|(a_px, a), (b_px, b)| weight(b).cmp(&weight(a)).then(b_px.total_cmp(a_px)));
    let mut placed: Vec<Note> = Vec::new();
    for (at_px, mut crowd) in crowds.into_iter().take(MOST_TRIED) {
        crowd.sort_by_key(|event| Reverse(event.weight));
        crowd.truncate(MOST_ROWS);
        crowd.sort_by_key(|event| event.number);
        // Of those there is no room for, the least important is left out.
        while let Some(least) = crowd
            .iter()
            .rposition(|event| crowd.iter().all(|other| event.weight <= other.weight))
        {
            let room = (0..MOST_ROWS)
                .map(|row| list(at_px, &crowd, row))
                .find(|list| {
                    let is_clear = |note: &Note| placed.iter().all(|other| note.is_clear_of(other));
                    list.iter()
                        .all(|note| note.row < MOST_ROWS && is_clear(note))
                });
            if let Some(list) = room {
                placed.extend(list);
                break;
            }
            crowd.remove(least);
        }
    }
    placed
}

/// Text of some events at one place, one below the other from a row on.
fn list(at_px: f64, events: &[&EventLine], first_row: usize) -> Vec<Note> {
    let label = |event: &&EventLine| {
        let mut label = format!("{} {}", event.number, event.text);
        if label.chars().count() > MOST_LETTERS {
            label = label.chars().take(MOST_LETTERS - 1).collect();
            label.push('…');
        }
        label
    };
    let labels: Vec<String> = events.iter().map(label).collect();
    let width_px = |label: &String| text_width_px(label, SMALL_PX);
    let widest_px = labels.iter().map(width_px).fold(0.0, f64::max);
    // Near the right edge the text is to the left.
    let is_left = at_px + 4.0 + widest_px > RIGHT_PX;
    let note = |(n, label): (usize, String)| {
        let width_px = width_px(&label);
        let left_px = if is_left {
            at_px - 4.0 - width_px
        } else {
            at_px + 4.0
        };
        Note {
            at_px,
            left_px,
            right_px: left_px + width_px,
            row: first_row + n,
            label,
        }
    };
    labels.into_iter().enumerate().map(note).collect()
}
