//! The event log of a flight, for its outcome.

use fcc_core::framework::{Controller, EventOf};

use super::observer::{FlightTime, Observer, Report, Reports};
use super::outcome::{EventEntry, Outcome};

/// The maximum number of stored events: a flight may take weeks, and the
/// recording has them all.
const MOST_EVENTS: usize = 10_000;

/// Stores events, for the outcome.
#[derive(Default)]
pub(super) struct EventLog(Vec<EventEntry>);

impl EventLog {
    fn keep(&mut self, text: &str, at: &FlightTime) {
        if self.0.len() < MOST_EVENTS {
            self.0.push(EventEntry {
                time_s: at.time_s,
                tick: at.tick,
                text: text.to_owned(),
            });
        }
    }
}

impl<C: Controller> Observer<C> for EventLog {
    fn event(&mut self, _: &EventOf<C>, words: &str, at: &FlightTime) {
        self.keep(words, at);
    }

    fn report(&mut self, report: &Report, at: &FlightTime) {
        if let Report::Remark(words) = report {
            self.keep(words, at);
        }
    }

    fn end(&mut self, _: &str, outcome: &mut Outcome, _: &mut Reports) {
        outcome.events = std::mem::take(&mut self.0);
    }
}
