//! The events, numbered as in the plots.

use fcc_core::framework::{Controller, EventKind, EventOf};
use serde::Serialize;

use super::origin::Origin;
use fcc_telemetry::describe_event;

/// At most this many events are kept; the rest are counted.
const MOST_EVENTS: usize = 2_000;

/// An event.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct EventLine {
    /// Number in the plots, from 1.
    pub number: usize,
    /// Since the first tick, s.
    pub time_s: f64,
    /// Number of the tick.
    pub tick: u64,
    /// Description.
    pub text: String,
    #[serde(skip)]
    pub(super) weight: Weight,
}

/// Importance of an event, for plots without room for all.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Weight {
    /// In the table only.
    Minor,
    /// A command.
    Command,
    /// A fault.
    Fault,
    /// A change of state.
    State,
}

/// Gathers the events.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    lines: Vec<EventLine>,
    count: usize,
}

impl Events {
    pub(super) fn take<C: Controller>(&mut self, time_s: f64, event: &EventOf<C>, origin: &Origin) {
        self.push(time_s, event.tick, weight(&event.kind), || {
            describe_event::<C>(event, &origin.sensors, &origin.actuators).replace("->", "\u{2192}")
        });
    }

    /// Takes a remark, which follows a tick.
    pub(super) fn remark(&mut self, time_s: f64, tick: u64, text: &str) {
        self.push(time_s, tick, Weight::Minor, || text.to_owned());
    }

    /// Takes a damage of the recording, which follows a tick.
    pub(super) fn damage(&mut self, time_s: f64, tick: u64, text: &str) {
        self.push(time_s, tick, Weight::Fault, || text.to_owned());
    }

    fn push(&mut self, time_s: f64, tick: u64, weight: Weight, text: impl FnOnce() -> String) {
        self.count += 1;
        if self.lines.len() < MOST_EVENTS {
            self.lines.push(EventLine {
                number: self.count,
                time_s,
                tick,
                text: text(),
                weight,
            });
        }
    }

    /// The events kept, and the count of all.
    pub(super) fn into_lines(self) -> (Vec<EventLine>, usize) {
        (self.lines, self.count)
    }
}

fn weight<T>(kind: &EventKind<T>) -> Weight {
    match kind {
        EventKind::StateChanged { .. }
        | EventKind::Panicked
        | EventKind::TimerFailed
        | EventKind::StoppedByOverload
        | EventKind::Hung { .. } => Weight::State,
        EventKind::SensorFault { .. }
        | EventKind::ActuatorFault { .. }
        | EventKind::RecordsDropped { .. }
        | EventKind::EventsDropped { .. }
        | EventKind::NotRecorded { .. }
        | EventKind::Overrun { .. }
        | EventKind::Overloaded { .. }
        | EventKind::Released { ok: false } => Weight::Fault,
        EventKind::CommandReceived(_)
        | EventKind::EngageRefused { .. }
        | EventKind::EngageRefusedBySwitch => Weight::Command,
        _ => Weight::Minor,
    }
}
