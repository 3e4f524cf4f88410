//! The producer of records and events: a ring that never waits.

use std::collections::VecDeque;

use fcc_core::framework::{Controller, Event, EventKind, Message, MessageOf, RecordOf, Tick};
use rtrb::Producer;

/// Slots of the ring reserved for events, for when records have not been read
/// for a while.
pub(crate) const EVENT_SLOTS: usize = 64;

/// A run of lost records or events.
#[derive(Default)]
struct Gap {
    count: u64,
    first: u64,
    last: u64,
}

impl Gap {
    fn widen(&mut self, tick: u64) {
        if self.count == 0 {
            self.first = tick;
        }
        self.count += 1;
        self.last = tick;
    }
}

/// Events of a tick, and earlier ones that the ring had no space for. Filled
/// during the tick, sent after its last actuator write.
pub(crate) struct Events<O> {
    waiting: VecDeque<Event<O>>,
    lost: Gap,
    dropped: u64,
}

impl<O> Events<O> {
    fn new() -> Self {
        Self {
            waiting: VecDeque::with_capacity(EVENT_SLOTS),
            lost: Gap::default(),
            dropped: 0,
        }
    }

    /// Stores an event until the end of the tick; counts it if there is no space.
    pub(crate) fn push(&mut self, tick: &Tick, kind: EventKind<O>) {
        // Never beyond its capacity: growing would allocate.
        if self.waiting.len() < EVENT_SLOTS {
            self.waiting.push_back(Event {
                tick: tick.number,
                time: tick.woke,
                kind,
            });
        } else {
            self.lost.widen(tick.number);
            self.dropped += 1;
        }
    }
}

/// The producer of the message ring.
pub(crate) struct TelemetryProducer<C: Controller> {
    ring: Producer<MessageOf<C>>,
    pub(crate) events: Events<C::Command>,
    lost: Gap,
    dropped: u64,
}

impl<C: Controller> TelemetryProducer<C> {
    pub(crate) fn new(ring: Producer<MessageOf<C>>) -> Self {
        Self {
            ring,
            events: Events::new(),
            lost: Gap::default(),
            dropped: 0,
        }
    }

    /// Sends pending events and this tick's record, or counts the record as lost.
    pub(crate) fn send(&mut self, record: &RecordOf<C>) {
        self.send_events(&record.tick);
        // A gap is reported right before the record that ends it.
        let needed = 1 + usize::from(self.lost.count > 0);
        if self.ring.slots() >= EVENT_SLOTS + needed {
            self.send_gap(&record.tick);
            self.push(Message::Tick(*record));
        } else {
            self.lost.widen(record.tick.number);
            self.dropped += 1;
        }
    }

    /// Sends what is pending after the last record.
    pub(crate) fn close(&mut self, tick: &Tick) {
        self.send_events(tick);
        self.send_gap(tick);
        self.events.dropped += self.events.waiting.len() as u64;
        self.events.waiting.clear();
    }

    /// Records lost since the start.
    pub(crate) const fn records_dropped(&self) -> u64 {
        self.dropped
    }

    /// Events lost since the start.
    pub(crate) const fn events_dropped(&self) -> u64 {
        self.events.dropped
    }

    fn send_events(&mut self, tick: &Tick) {
        while let Some(event) = self.events.waiting.front() {
            let event = *event;
            if !self.push(Message::Event(event)) {
                return;
            }
            self.events.waiting.pop_front();
        }
        let Gap { count, first, last } = self.events.lost;
        if count > 0 && self.send_event(tick, EventKind::EventsDropped { count, first, last }) {
            self.events.lost = Gap::default();
        }
    }

    fn send_gap(&mut self, tick: &Tick) {
        let Gap { count, first, last } = self.lost;
        if count > 0 && self.send_event(tick, EventKind::RecordsDropped { count, first, last }) {
            self.lost = Gap::default();
        }
    }

    fn send_event(&mut self, tick: &Tick, kind: EventKind<C::Command>) -> bool {
        self.push(Message::Event(Event {
            tick: tick.number,
            time: tick.woke,
            kind,
        }))
    }

    fn push(&mut self, message: MessageOf<C>) -> bool {
        self.ring.push(message).is_ok()
    }
}
