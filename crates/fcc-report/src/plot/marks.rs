//! Events as numbered marks, as far as there is room.

use super::super::events::{EventLine, Weight};
use super::sheet::{SMALL_PX, text_width_px};

/// One mark for events that are too close to be distinguished.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Mark {
    /// Of the most important event, px on the sheet.
    pub(crate) at_px: f64,
    /// Number of the first.
    first: usize,
    /// Number of the last.
    last: usize,
    /// Of the most important event.
    weight: Weight,
}

/// Marks for all events, without overlap; `x_px` converts a time to px.
pub(crate) fn marks(events: &[EventLine], x_px: impl Fn(f64) -> f64) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    for event in events {
        let mut mark = Mark {
            at_px: x_px(event.time_s),
            first: event.number,
            last: event.number,
            weight: event.weight,
        };
        // A joint mark is wider, and may touch the previous one.
        while let Some(before) = marks.pop_if(|before| before.touches(&mark)) {
            mark = before.join(mark);
        }
        marks.push(mark);
    }
    marks
}

impl Mark {
    /// The numbers of its events.
    pub(crate) fn label(&self) -> String {
        if self.first == self.last {
            self.first.to_string()
        } else {
            format!("{}\u{2013}{}", self.first, self.last)
        }
    }

    /// Its events as text, a line for each of the first few.
    pub(crate) fn description(&self, events: &[EventLine]) -> String {
        const MOST: usize = 12;
        let own = events
            .iter()
            .filter(|event| (self.first..=self.last).contains(&event.number));
        let lines: Vec<String> = own
            .take(MOST)
            .map(|event| format!("{} {}", event.number, event.text))
            .collect();
        let more = (self.last - self.first + 1).saturating_sub(MOST);
        match more {
            0 => lines.join("\n"),
            more => format!("{}\nand {more} more", lines.join("\n")),
        }
    }

    fn half_width_px(&self) -> f64 {
        text_width_px(&self.label(), SMALL_PX) / 2.0
    }

    fn touches(&self, later: &Self) -> bool {
        let apart_px = later.at_px - self.at_px;
        apart_px < self.half_width_px() + later.half_width_px() + 5.0
    }

    fn join(self, later: Self) -> Self {
        let weightier = if later.weight > self.weight {
            later
        } else {
            self
        };
        Self {
            first: self.first,
            last: later.last,
            ..weightier
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(number: usize, time_s: f64, weight: Weight) -> EventLine {
        EventLine {
            number,
            time_s,
            tick: 0,
            text: String::new(),
            weight,
        }
    }

    #[test]
    fn close_events_share_a_mark_at_the_most_important() {
        let events = [
            event(1, 0.0, Weight::Minor),
            event(2, 100.0, Weight::Command),
            event(3, 101.0, Weight::State),
            event(4, 102.0, Weight::Minor),
            event(5, 300.0, Weight::Fault),
        ];
        let marks = marks(&events, |time_s| time_s);
        let seen: Vec<_> = marks.iter().map(|m| (m.label(), m.at_px)).collect();
        let seen: Vec<_> = seen.iter().map(|(l, at)| (l.as_str(), *at)).collect();
        assert_eq!(seen, [("1", 0.0), ("2\u{2013}4", 101.0), ("5", 300.0)]);
    }
}
