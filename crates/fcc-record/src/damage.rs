//! Damage inside a recording, and the part of the flight that is missing
//! because of it.

use std::fmt;

use fcc_core::framework::{Event, EventKind, Tick, Time};
use serde::Serialize;

use super::end::End;
use super::raw::DamagedBytes;
use super::remark::Remark;

/// Bytes of a recording that are not what was written, and the part of the
/// flight that is missing because of it.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Damage {
    /// Offset of the first damaged byte.
    pub from_byte: u64,
    /// Offset at which reading continued.
    pub to_byte: u64,
    /// What is wrong, as text.
    pub why: String,
    /// The number of missing ticks, if known.
    pub ticks: Option<u64>,
    /// The first missing tick, if known.
    pub first_tick: Option<u64>,
    /// The last missing tick, if known.
    pub last_tick: Option<u64>,
    /// Time from the tick before to the tick after, s, if both are known.
    pub span_s: Option<f64>,
    /// Whether records or events may have been lost, and not only an index or
    /// metadata.
    pub messages: bool,
    /// The tick before it and its wake-up time, on the loop's clock.
    #[serde(skip)]
    pub after: Option<(u64, Time)>,
}

impl Damage {
    pub(super) fn of(damaged: DamagedBytes) -> Self {
        Self {
            from_byte: damaged.bytes.start,
            to_byte: damaged.bytes.end,
            why: damaged.why,
            ticks: (!damaged.messages).then_some(0),
            first_tick: None,
            last_tick: None,
            span_s: None,
            messages: damaged.messages,
            after: None,
        }
    }

    /// Adds damage with no tick between.
    pub(super) fn join(&mut self, more: &DamagedBytes) {
        self.from_byte = self.from_byte.min(more.bytes.start);
        self.to_byte = self.to_byte.max(more.bytes.end);
        self.messages |= more.messages;
        self.ticks = self.ticks.filter(|_| !self.messages);
    }

    /// Finds which ticks are missing between two that were read. `end` gives
    /// the first and the last tick of the flight, if known.
    pub(super) fn locate(&mut self, before: Option<&Tick>, next: Option<&Tick>, end: Option<&End>) {
        self.after = before.map(|tick| (tick.number, tick.woke));
        let first = match before {
            Some(tick) => Some(tick.number.saturating_add(1)),
            None => end.map(|end| end.first_tick),
        };
        let last = match next {
            Some(tick) => Some(tick.number.saturating_sub(tick.missed.saturating_add(1))),
            None => end.map(|end| end.last_tick),
        };
        if let (Some(first), Some(last), true) = (first, last, self.messages) {
            let ticks = last.saturating_add(1).saturating_sub(first);
            self.ticks = Some(ticks);
            self.first_tick = (ticks > 0).then_some(first);
            self.last_tick = (ticks > 0).then_some(last);
        }
        self.span_s = before
            .zip(next)
            .map(|(before, next)| (next.woke - before.woke) as f64 * 1e-9)
            .filter(|_| self.first_tick.is_some());
    }
}

impl Damage {
    /// The gap as an event of the loop; none if nothing of the flight is
    /// missing. If no tick precedes it, it is at the tick that follows.
    pub fn event<C>(&self) -> Option<Event<C>> {
        if !self.messages {
            return None;
        }
        let (before, time) = self.after.unwrap_or((0, Time::NEVER));
        let first = self.first_tick.unwrap_or(before.saturating_add(1));
        let last = self.last_tick.unwrap_or(first);
        Some(Event {
            tick: last,
            time,
            kind: EventKind::NotRecorded {
                count: self.ticks.unwrap_or(0).max(1),
                first,
                last,
            },
        })
    }
}

impl Damage {
    /// The text of the [event](Self::event).
    pub(super) fn event_text(&self) -> String {
        match self.event::<()>().map(|event| event.kind) {
            Some(EventKind::NotRecorded { count, first, last }) => {
                format!("{count} messages not recorded, ticks {first} to {last}: damaged")
            }
            _ => String::new(),
        }
    }

    /// As a remark, at its place in the recording.
    pub fn remark(&self) -> Remark {
        Remark {
            time: self.after.map_or(Time::NEVER, |(_, time)| time),
            text: format!("the recording was {self}"),
        }
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            from_byte,
            to_byte,
            why,
            ..
        } = self;
        write!(f, "damaged from byte {from_byte} to {to_byte} ({why}): ")?;
        match (self.first_tick, self.last_tick, self.ticks) {
            _ if !self.messages => f.write_str("no tick and no event is missing"),
            (Some(first), Some(last), _) => {
                write!(f, "ticks {first} to {last} are missing")?;
                self.span_s
                    .map_or(Ok(()), |span_s| write!(f, ", {span_s:.3} s"))
            }
            (_, _, Some(_)) => f.write_str("no tick is missing, events may be"),
            (_, _, None) => f.write_str("how much of the flight is missing is not known"),
        }
    }
}
