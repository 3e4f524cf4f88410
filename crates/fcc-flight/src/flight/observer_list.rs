//! The observers of a run, each called in turn, whatever the vehicle is.

use fcc_core::framework::{Actuator, Controller, Message, MessageOf, Sensor};
use fcc_runtime::CommandSender;
use fcc_telemetry::describe_event;

use super::host::Host;
use super::monitor::Monitor;
use super::observer::{Access, Facts, Observer, Reports};
use super::outcome::Outcome;
use crate::config::NO_ACTUATOR;

/// All observers of a run.
pub(crate) struct ObserverList<C: Controller> {
    all: Vec<Box<dyn Observer<C>>>,
    names: Names,
    pub(crate) monitor: Monitor,
    reports: Reports,
}

impl<C: Controller> ObserverList<C> {
    pub(crate) fn new(all: Vec<Box<dyn Observer<C>>>, names: Names) -> Self {
        Self {
            all,
            names,
            monitor: Monitor::default(),
            reports: Reports::default(),
        }
    }

    pub(crate) fn prepare(&mut self) {
        self.each(|observer, reports| observer.prepare(reports));
    }

    pub(crate) fn begin(&mut self, facts: &Facts<'_>) {
        self.each(|observer, reports| observer.begin(facts, reports));
        if facts.actuators.is_empty() {
            self.remark(NO_ACTUATOR);
        }
    }

    /// Passes on a message of the loop; returns the description of an event.
    pub(crate) fn take(&mut self, message: &MessageOf<C>) -> Option<String> {
        let at = self.monitor.take(message);
        match message {
            Message::Tick(record) => {
                for observer in &mut self.all {
                    observer.record(record, &at);
                }
                None
            }
            Message::Event(event) => {
                let words = describe_event::<C>(event, &self.names.sensors, &self.names.actuators);
                for observer in &mut self.all {
                    observer.event(event, &words, &at);
                }
                Some(words)
            }
        }
    }

    /// Polls each observer.
    pub(crate) fn poll(&mut self, commands: &mut CommandSender<C::Command>, host: &mut dyn Host) {
        self.each(|observer, reports| {
            observer.poll(&mut Access {
                commands,
                reports,
                before_control: &mut || host.before_control(),
            });
        });
    }

    /// Passes on a remark that is not from an observer.
    pub(crate) fn remark(&mut self, words: impl Into<String>) {
        self.reports.remark(words);
        self.deliver(None);
    }

    pub(crate) fn stopping(&mut self) {
        self.each(|observer, _| observer.stopping());
    }

    /// Ends each, in their order, so that the following ones receive what one
    /// reports at its end.
    pub(crate) fn end(mut self, ending: &str, outcome: &mut Outcome) {
        self.each(|observer, reports| observer.end(ending, outcome, reports));
    }

    fn each(&mut self, mut act: impl FnMut(&mut dyn Observer<C>, &mut Reports)) {
        for number in 0..self.all.len() {
            if let Some(observer) = self.all.get_mut(number) {
                act(observer.as_mut(), &mut self.reports);
            }
            self.deliver(Some(number));
        }
    }

    /// Passes on what was reported, except to its reporter.
    fn deliver(&mut self, reporter: Option<usize>) {
        let at = self.monitor.at();
        for report in self.reports.take() {
            for (number, observer) in self.all.iter_mut().enumerate() {
                if Some(number) != reporter {
                    observer.report(&report, &at);
                }
            }
        }
    }
}

/// The names of sensors and actuators, which the loop identifies by their
/// index.
#[derive(Clone)]
pub(crate) struct Names {
    pub(crate) sensors: Vec<String>,
    pub(crate) actuators: Vec<String>,
}

impl Names {
    pub(crate) fn of<M, O>(
        sensors: &[Box<dyn Sensor<M>>],
        actuators: &[Box<dyn Actuator<O>>],
    ) -> Self {
        Self {
            sensors: distinct(sensors.iter().map(|sensor| sensor.name())),
            actuators: distinct(actuators.iter().map(|actuator| actuator.name())),
        }
    }
}

/// Unique names: of several devices with one name, all but the first get a
/// number.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut seen: Vec<&str> = Vec::new();
    names
        .map(|name| {
            seen.push(name);
            match seen.iter().filter(|other| **other == name).count() {
                1 => name.to_owned(),
                number => format!("{name} {number}"),
            }
        })
        .collect()
}
