//! Messages that are not in a file: how many, and of which ticks.

use fcc_core::framework::{Event, EventKind, Message, Time};

/// Messages missing between two that were recorded.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Lost {
    pub(super) count: u64,
    pub(super) first: u64,
    pub(super) last: u64,
}

impl Lost {
    /// The gap that a message reports, if it reports one.
    pub(super) fn reported_by<M, E, S, O, R>(message: &Message<M, E, S, O, R>) -> Option<Self> {
        match message {
            Message::Event(event) => match event.kind {
                EventKind::NotRecorded { count, first, last } => Some(Self { count, first, last }),
                _ => None,
            },
            Message::Tick(_) => None,
        }
    }

    pub(super) const fn is_none(&self) -> bool {
        self.count == 0
    }

    /// Adds a message.
    pub(super) fn widen<M, E, S, O, R>(&mut self, message: &Message<M, E, S, O, R>) {
        let (tick, _) = place(message);
        self.join(Self {
            count: 1,
            first: tick,
            last: tick,
        });
    }

    /// Adds a later gap, with no recorded message between.
    pub(super) fn join(&mut self, later: Self) {
        if self.is_none() {
            *self = later;
        } else if !later.is_none() {
            self.count = self.count.saturating_add(later.count);
            self.last = later.last;
        }
    }

    /// The gap as an event, at the message after it.
    pub(super) fn event<M, E, S, O, R>(
        &self,
        next: Option<&Message<M, E, S, O, R>>,
    ) -> Message<M, E, S, O, R> {
        let (tick, time) = next.map_or((self.last, Time::NEVER), place);
        Message::Event(Event {
            tick,
            time,
            kind: EventKind::NotRecorded {
                count: self.count,
                first: self.first,
                last: self.last,
            },
        })
    }

    /// For users; after an earlier gap, or not.
    pub(super) fn description(&self, is_after_another: bool) -> String {
        if self.is_none() {
            "nothing is lost".to_owned()
        } else {
            let earlier = if self.first > 1 && !is_after_another {
                ", all earlier ones are recorded"
            } else {
                ""
            };
            format!(
                "{} messages of ticks {} to {} are lost{earlier}",
                self.count, self.first, self.last
            )
        }
    }
}

fn place<M, E, S, O, R>(message: &Message<M, E, S, O, R>) -> (u64, Time) {
    match message {
        Message::Tick(record) => (record.tick.number, record.tick.woke),
        Message::Event(event) => (event.tick, event.time),
    }
}
