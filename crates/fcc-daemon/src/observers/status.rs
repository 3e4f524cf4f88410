//! A status line each second, and in standby what engaging needs, when that changes.

use std::fmt::Write as _;

use fcc_core::framework::{Controller, EventKind, EventOf, RecordOf, State, Switch};
use fcc_flight::flight::{FlightTime, Observer};

use crate::output;

/// Prints a line for each second of the loop's time, on standard error.
pub(crate) struct StatusLine<C: Controller> {
    /// The plant's part of the line; none before there are measurements.
    describe: fn(&RecordOf<C>) -> Option<String>,
    /// Whether the engage switch is read, and its position.
    switch: fn(&RecordOf<C>) -> Option<Switch>,
    /// Whether a command engages although that switch is off.
    by_command: bool,
    printed_s: Option<f64>,
    /// What engaging needed a second before, and whether that was printed.
    needed: (Option<String>, bool),
    /// Whether the switch was on a second before: one that has just gone on engages.
    was_on: bool,
    worst_us: f64,
    missed: u64,
    overloaded: bool,
}

impl<C: Controller> Observer<C> for StatusLine<C> {
    fn record(&mut self, record: &RecordOf<C>, at: &FlightTime) {
        self.worst_us = self
            .worst_us
            .max(record.tick.lateness().as_secs_f64() * 1e6);
        self.missed += record.tick.missed;
        // Slightly early, so that rounding of ticks does not skip a second.
        if self
            .printed_s
            .is_none_or(|last| at.time_s - last >= 1.0 - 1e-6)
        {
            self.printed_s = Some(at.time_s);
            let plant = (self.describe)(record);
            // Without measurements all of them are missing.
            let needs = plant.as_ref().and_then(|_| self.needs(record));
            // What lasts for a second: not the beginning of a flight, which engages by itself.
            let was_printed = needs == self.needed.0 && self.needed.1;
            let is_due = needs.is_some() && needs == self.needed.0 && !was_printed;
            if let Some(needs) = needs.as_ref().filter(|_| is_due) {
                output::message(format!("{:8.2} s  {needs}", at.time_s));
            }
            self.needed = (needs, was_printed || is_due);
            self.was_on = (self.switch)(record) == Some(Switch::On);
            output::message(self.line(plant, record, at));
            self.worst_us = 0.0;
        }
    }

    fn event(&mut self, event: &EventOf<C>, _: &str, _: &FlightTime) {
        match event.kind {
            EventKind::Overloaded { .. } => self.overloaded = true,
            EventKind::OverloadOver { .. } => self.overloaded = false,
            _ => {}
        }
    }
}

impl<C: Controller> StatusLine<C> {
    pub(crate) const fn new(
        describe: fn(&RecordOf<C>) -> Option<String>,
        switch: fn(&RecordOf<C>) -> Option<Switch>,
        by_command: bool,
    ) -> Self {
        Self {
            describe,
            switch,
            by_command,
            printed_s: None,
            needed: (None, false),
            was_on: false,
            worst_us: 0.0,
            missed: 0,
            overloaded: false,
        }
    }

    /// What engaging needs, in standby.
    fn needs(&self, record: &RecordOf<C>) -> Option<String> {
        if record.state != State::Standby {
            return None;
        }
        if !record.engage_inhibits.is_empty() {
            let names: Vec<&str> = record.engage_inhibits.iter().map(C::flag_name).collect();
            return Some(format!("not ready: {}", names.join(", ")));
        }
        let needs = match ((self.switch)(record), self.by_command) {
            (None, _) => "waits for a command: no engage switch is read",
            (Some(Switch::Off), true) => "waits for the engage switch or a command",
            (Some(Switch::Off), false) => "waits for the engage switch",
            (Some(Switch::On), _) if !self.was_on => return self.needed.0.clone(),
            (Some(Switch::On), _) => "waits for a command, or the engage switch off and on",
        };
        Some(needs.to_owned())
    }

    /// Of 80 columns at most: what a terminal has.
    fn line(&self, plant: Option<String>, record: &RecordOf<C>, at: &FlightTime) -> String {
        let plant = plant.unwrap_or_else(|| "no measurements yet".to_owned());
        // Engaged, the plant's part begins with its mode.
        let state = match record.state.state() {
            State::Engaged => String::new(),
            state => format!("{:<10}", state.to_string()),
        };
        let mut line = format!(
            "{:8.2} s  {state}{plant}  ≤{:5.0} µs",
            at.time_s, self.worst_us
        );
        if self.missed > 0 {
            let _ = write!(line, "  missed {}", self.missed);
        }
        if self.overloaded {
            line.push_str("  overload");
        }
        if record.state == State::Standby && !record.engage_inhibits.is_empty() {
            line.push_str("  not ready");
        }
        line
    }
}
