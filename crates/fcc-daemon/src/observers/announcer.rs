//! Prints events as they happen.

use fcc_core::framework::{Controller, EventOf};
use fcc_flight::flight::{FlightTime, Observer, Report};

use crate::output;

/// Prints each event and report on standard error.
pub(crate) struct Announcer;

impl<C: Controller> Observer<C> for Announcer {
    fn event(&mut self, _: &EventOf<C>, text: &str, at: &FlightTime) {
        announce(text, at);
    }

    fn report(&mut self, report: &Report, at: &FlightTime) {
        match report {
            Report::Remark(text) | Report::Mention(text) => announce(text, at),
            Report::Recording(_) => {}
        }
    }
}

fn announce(text: &str, at: &FlightTime) {
    output::message(format!("{:8.2} s  {text}", at.time_s));
}
