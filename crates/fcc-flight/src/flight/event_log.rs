//! The event log of a flight, for its outcome.

use fcc_core::framework::{Controller, EventOf, RecordOf};

use super::flapping::Flapping;
use super::observer::{FlightTime, Observer, Report, Reports};
use super::outcome::{EventEntry, Outcome};

/// The maximum number of stored events: a flight may take weeks, and the
/// recording has them all.
const MOST_EVENTS: usize = 10_000;

/// Stores events, for the outcome.
#[derive(Default)]
pub(crate) struct EventLog {
    events: Vec<EventEntry>,
    flapping: Flapping,
    at: FlightTime,
}

impl EventLog {
    fn keep(&mut self, text: &str, at: &FlightTime) {
        if self.events.len() < MOST_EVENTS {
            self.events.push(EventEntry {
                time_s: at.time_s,
                tick: at.tick,
                text: text.to_owned(),
            });
        }
    }

    fn summarise(&mut self, at: &FlightTime, at_the_end: bool) {
        let lines: Vec<_> = self.flapping.summaries(at.time_s, at_the_end).collect();
        for line in lines {
            self.keep(&line, at);
        }
    }
}

impl<C: Controller> Observer<C> for EventLog {
    fn record(&mut self, _: &RecordOf<C>, at: &FlightTime) {
        self.at = *at;
        self.summarise(at, false);
    }

    fn event(&mut self, event: &EventOf<C>, words: &str, at: &FlightTime) {
        if self.flapping.passes(&event.kind, words, at.time_s) {
            self.keep(words, at);
        }
    }

    fn report(&mut self, report: &Report, at: &FlightTime) {
        if let Report::Remark(words) = report {
            self.keep(words, at);
        }
    }

    fn end(&mut self, _: &str, outcome: &mut Outcome, _: &mut Reports) {
        let at = self.at;
        self.summarise(&at, true);
        outcome.events = std::mem::take(&mut self.events);
    }
}
