//! Prints events as they happen.

use fcc_core::framework::{Controller, EventOf, RecordOf};
use fcc_flight::flight::{Flapping, FlightTime, Observer, Report};

use crate::output;

/// Prints events and reports on standard error; a fault that comes and goes is
/// summarised.
#[derive(Default)]
pub(crate) struct Announcer(Flapping);

impl<C: Controller> Observer<C> for Announcer {
    fn record(&mut self, _: &RecordOf<C>, at: &FlightTime) {
        for line in self.0.summaries(at.time_s, false) {
            announce(&line, at);
        }
    }

    fn event(&mut self, event: &EventOf<C>, text: &str, at: &FlightTime) {
        if self.0.passes(&event.kind, text, at.time_s) {
            announce(text, at);
        }
    }

    fn report(&mut self, report: &Report, at: &FlightTime) {
        match report {
            Report::Remark(text) => announce(text, at),
            // It is not of a tick: in lockstep the loop is ahead of it.
            Report::Mention(text) => output::message(format!("{:10}  {text}", "")),
            Report::Recording(_) | Report::Plan(_) => {}
        }
    }
}

fn announce(text: &str, at: &FlightTime) {
    output::message(format!("{:8.2} s  {text}", at.time_s));
}
