//! Events as numbered marks, as many as there is room for.

use super::super::events::{EventLine, Weight};
use super::canvas::{SMALL_PX, text_width_px};

/// Events that are too close to be told apart, under one mark.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Mark {
    /// Of the weightiest of them, px on the sheet.
    pub(super) at_px: f64,
    /// Their numbers.
    pub(super) label: String,
    /// Of the weightiest.
    pub(super) weight: Weight,
}

/// Marks for all events, none on top of another; `x_px` says where on the
/// sheet a time is.
pub(super) fn marks(events: &[EventLine], x_px: impl Fn(f64) -> f64) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    let mut first = 0;
    let mut last_at_px = f64::NEG_INFINITY;
    for event in events {
        let at_px = x_px(event.time_s);
        let joins = marks.last().is_some_and(|mark| {
            let own = text_width_px(&event.number.to_string(), SMALL_PX);
            at_px - last_at_px < half_width(&mark.label) + own / 2.0 + 4.0
        });
        match marks.last_mut() {
            Some(mark) if joins => {
                mark.label = format!("{first}\u{2013}{}", event.number);
                if event.weight > mark.weight {
                    mark.weight = event.weight;
                    mark.at_px = at_px;
                }
            }
            _ => {
                first = event.number;
                last_at_px = at_px;
                marks.push(Mark {
                    at_px,
                    label: event.number.to_string(),
                    weight: event.weight,
                });
            }
        }
    }
    marks
}

fn half_width(label: &str) -> f64 {
    text_width_px(label, SMALL_PX) / 2.0
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
    fn close_events_share_a_mark_at_the_weightiest() {
        let events = [
            event(1, 0.0, Weight::Minor),
            event(2, 100.0, Weight::Asked),
            event(3, 101.0, Weight::State),
            event(4, 102.0, Weight::Minor),
            event(5, 300.0, Weight::Wrong),
        ];
        let marks = marks(&events, |time_s| time_s);
        let seen: Vec<_> = marks.iter().map(|m| (m.label.as_str(), m.at_px)).collect();
        assert_eq!(seen, [("1", 0.0), ("2\u{2013}4", 101.0), ("5", 300.0)]);
    }
}
