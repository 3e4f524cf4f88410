//! Runs recorded inputs through the loop.

use fcc_core::flight::{Autopilot, Measurements};
use fcc_core::framework::{Message, State};
use fcc_runtime::{Link, Machine, Parts};
use fcc_telemetry::{FlightMessage, FlightRecord};
use fcc_timer::{Expiry, TimerError};
use rtrb::Producer;
use serde::Serialize;

use super::parts::{NoAircraft, RecordedSensor, RecordedTimes};
use super::sequence::{Cut, Sequence};
use crate::config::Config;

/// A loop that flies what was recorded.
pub struct Replay {
    machine: Machine<Autopilot>,
    link: Link<Autopilot>,
    measured: Producer<Measurements>,
    sequence: Sequence,
}

impl Replay {
    /// A loop as `config` says, before its first tick.
    ///
    /// # Errors
    /// When the period cannot be kept statistics of.
    pub fn new(config: &Config) -> Result<Self, TimerError> {
        let (measured, sensor) = RecordedSensor::new();
        let parts = Parts {
            timer: Box::new(RecordedTimes {
                period: config.tick.period(),
            }),
            sensors: vec![Box::new(sensor)],
            controller: Autopilot::new(config.autopilot_config()),
            actuators: vec![Box::new(NoAircraft)],
        };
        let (mut machine, link) = Machine::new(parts, &config.loop_config())?;
        machine.start()?;
        Ok(Self {
            machine,
            link,
            measured,
            sequence: Sequence::default(),
        })
    }

    /// Takes the next message of a recording. A record's tick is flown again,
    /// and its record of now comes back.
    ///
    /// # Errors
    /// When it cannot be flown from here on.
    pub fn take(&mut self, message: &FlightMessage) -> Result<Option<&FlightRecord>, Cut> {
        let (Some(inputs), Message::Tick(recorded)) = (self.sequence.take(message)?, message)
        else {
            return Ok(None);
        };
        let tick = &recorded.tick;
        if self.machine.state() == State::Stopped {
            return Err(Cut::StoppedEarly { tick: tick.number });
        }
        for command in inputs.commands {
            // A tick reads 16 at most, and the ring holds more.
            let sent = self.link.commands.send(command);
            sent.map_err(|_| Cut::OrderOutOfPlace { tick: tick.number })?;
        }
        if inputs.stop_requested {
            self.link.stop.stop();
        }
        // The ring is empty: the sensor takes what is in it in every tick.
        let _ = self.measured.push(recorded.measurements);
        let expiry = Expiry {
            number: tick.number,
            scheduled_ns: tick.scheduled.as_nanos(),
            woke_ns: tick.woke.as_nanos(),
            missed: tick.missed,
            early_wake_ns: recorded.early_wake_ns,
            ..Expiry::default()
        };
        self.machine.tick_again(expiry, recorded.stages);
        while self.link.messages.receive().is_some() {}
        Ok(Some(self.machine.record()))
    }
}

/// How far a recording was flown again.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Run {
    /// Ticks flown again.
    pub ticks: u64,
    /// The last of them; none if there is none.
    pub last_tick: Option<u64>,
    /// From the first of them to the last, s.
    pub span_s: f64,
    /// What was not flown again; none if all was.
    pub unflown: Option<Unflown>,
}

/// The part of a recording that was not flown again.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Unflown {
    /// How many recorded ticks.
    pub ticks: u64,
    /// The first of them, if there is one.
    pub first: Option<u64>,
    /// The last of them.
    pub last: Option<u64>,
    /// Why, in words for people.
    pub why: String,
}

/// Flies a recording again, as far as it goes, and shows `compare` each tick
/// as recorded and as flown again.
pub fn run(
    mut replay: Replay,
    messages: impl IntoIterator<Item = FlightMessage>,
    mut compare: impl FnMut(&FlightRecord, &FlightRecord),
) -> Run {
    let mut run = Run::default();
    let mut began_ns = None;
    for message in messages {
        if let Some(unflown) = &mut run.unflown {
            unflown.count(&message);
            continue;
        }
        match (replay.take(&message), &message) {
            (Ok(Some(again)), Message::Tick(recorded)) => {
                let at_ns = recorded.tick.scheduled.as_nanos();
                run.span_s = at_ns.saturating_sub(*began_ns.get_or_insert(at_ns)) as f64 * 1e-9;
                run.ticks += 1;
                run.last_tick = Some(recorded.tick.number);
                compare(recorded, again);
            }
            (Ok(_), _) => {}
            (Err(cut), message) => {
                let unflown = run.unflown.insert(Unflown {
                    ticks: 0,
                    first: None,
                    last: None,
                    why: cut.to_string(),
                });
                unflown.count(message);
            }
        }
    }
    run
}

impl Unflown {
    fn count(&mut self, message: &FlightMessage) {
        if let Message::Tick(record) = message {
            self.ticks += 1;
            self.first.get_or_insert(record.tick.number);
            self.last = Some(record.tick.number);
        }
    }
}
