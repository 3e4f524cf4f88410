//! What happens, as it happens, for who watches.

use fcc_flight::flight::{FlightTime, Observer, Report};
use fcc_telemetry::FlightEvent;

use crate::output;

/// Prints each event and report on standard error.
pub(crate) struct Announcer;

impl Observer for Announcer {
    fn event(&mut self, _: &FlightEvent, words: &str, at: &FlightTime) {
        announce(words, at);
    }

    fn report(&mut self, report: &Report, at: &FlightTime) {
        match report {
            Report::Remark(words) | Report::Mention(words) => announce(words, at),
            Report::Recording(_) => {}
        }
    }
}

fn announce(words: &str, at: &FlightTime) {
    output::message(format!("{:8.2} s  {words}", at.time_s));
}
