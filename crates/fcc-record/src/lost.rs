//! What did not get into a file: how many messages, and of which ticks.

use fcc_core::framework::{Event, EventKind, Time};

use fcc_telemetry::FlightMessage;

/// Messages that are missing between two that are not.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Lost {
    pub(super) count: u64,
    pub(super) first: u64,
    pub(super) last: u64,
}

impl Lost {
    /// The gap that a message tells of, if it is one that does.
    pub(super) fn told_by(message: &FlightMessage) -> Option<Self> {
        match message {
            FlightMessage::Event(event) => match event.kind {
                EventKind::NotRecorded { count, first, last } => Some(Self { count, first, last }),
                _ => None,
            },
            FlightMessage::Tick(_) => None,
        }
    }

    pub(super) const fn is_none(&self) -> bool {
        self.count == 0
    }

    /// One message more.
    pub(super) fn widen(&mut self, message: &FlightMessage) {
        let (tick, _) = place(message);
        self.join(Self {
            count: 1,
            first: tick,
            last: tick,
        });
    }

    /// A later gap, with nothing between that was kept.
    pub(super) fn join(&mut self, later: Self) {
        if self.is_none() {
            *self = later;
        } else if !later.is_none() {
            self.count = self.count.saturating_add(later.count);
            self.last = later.last;
        }
    }

    /// The gap as an event, at the message that ends it.
    pub(super) fn event(&self, next: Option<&FlightMessage>) -> FlightMessage {
        let (tick, time) = next.map_or((self.last, Time::NEVER), place);
        FlightMessage::Event(Event {
            tick,
            time,
            kind: EventKind::NotRecorded {
                count: self.count,
                first: self.first,
                last: self.last,
            },
        })
    }

    /// For people.
    pub(super) fn words(&self) -> String {
        if self.is_none() {
            "nothing is lost".to_owned()
        } else {
            format!(
                "{} messages of ticks {} to {} are lost, all before is safe",
                self.count, self.first, self.last
            )
        }
    }
}

fn place(message: &FlightMessage) -> (u64, Time) {
    match message {
        FlightMessage::Tick(record) => (record.tick.number, record.tick.woke),
        FlightMessage::Event(event) => (event.tick, event.time),
    }
}
