//! Runs the loop with recorded inputs.

use std::time::Duration;

use fcc_core::framework::{Controller, Message, MessageOf, RecordOf, State, Tick};
use fcc_record::Document;
use fcc_runtime::{Link, LoopConfig, Machine, Parts};
use fcc_telemetry::expiry_of;
use fcc_timer::TimerError;
use rtrb::Producer;
use serde::Serialize;

use super::parts::{NoPlant, RecordedSensor, RecordedTimes};
use super::sequence::{Cut, Sequence};

/// A loop with recorded inputs.
pub struct Replay<C: Controller> {
    machine: Machine<C>,
    link: Link<C>,
    measured: Producer<C::Measurements>,
    sequence: Sequence<C::Command>,
    pub(super) documents: Documents,
}

/// Takes the documents of a recording, each before the messages that refer to it.
pub(super) type Documents = Option<Box<dyn FnMut(&Document)>>;

impl<C: Controller> Replay<C> {
    /// A loop of this controller, before its first tick.
    ///
    /// # Errors
    /// When the period is out of range for the statistics.
    pub fn new(controller: C, period: Duration, config: &LoopConfig) -> Result<Self, TimerError> {
        let (measured, sensor) = RecordedSensor::new();
        let parts = Parts {
            timer: Box::new(RecordedTimes { period }),
            sensors: vec![Box::new(sensor)],
            controller,
            actuators: vec![Box::new(NoPlant)],
        };
        let (mut machine, link) = Machine::new(parts, config)?;
        machine.start()?;
        Ok(Self {
            machine,
            link,
            measured,
            sequence: Sequence::default(),
            documents: None,
        })
    }

    /// With what takes the documents of a recording, each before the messages that refer
    /// to it.
    #[must_use]
    pub fn with_documents(self, take: impl FnMut(&Document) + 'static) -> Self {
        Self {
            documents: Some(Box::new(take)),
            ..self
        }
    }

    /// The controller, after what was replayed so far.
    pub const fn controller(&self) -> &C {
        self.machine.controller()
    }

    /// Takes the next message of a recording. For a record, performs its tick
    /// again and returns the new record.
    ///
    /// # Errors
    /// When the rest cannot be replayed.
    pub fn take(&mut self, message: &MessageOf<C>) -> Result<Option<&RecordOf<C>>, Cut> {
        let (Some(inputs), Message::Tick(recorded)) = (self.sequence.take(message)?, message)
        else {
            return Ok(None);
        };
        let tick = &recorded.tick;
        if self.machine.state() == State::Stopped {
            return Err(Cut::StoppedEarly { tick: tick.number });
        }
        for command in inputs.commands {
            // A tick reads at most 16, and the ring holds more.
            let sent = self.link.commands.send(command);
            sent.map_err(|_| Cut::CommandOutOfPlace { tick: tick.number })?;
        }
        if inputs.stop_requested {
            self.link.stop.stop();
        }
        // The ring is empty: the sensor reads it in every tick.
        let _ = self.measured.push(recorded.measurements);
        self.machine
            .tick_again(expiry_of(recorded), recorded.stages);
        while self.link.messages.receive().is_some() {}
        Ok(Some(self.machine.record()))
    }
}

/// The replayed part of a recording.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Run {
    /// Ticks replayed.
    pub ticks: u64,
    /// The last of them; `None` if there is none.
    pub last_tick: Option<u64>,
    /// From the first of them to the last, s.
    pub span_s: f64,
    /// The part that was not replayed; `None` if all was.
    pub unflown: Option<NotReplayed>,
}

/// The part of a recording that was not replayed.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct NotReplayed {
    /// Number of recorded ticks.
    pub ticks: u64,
    /// The first of them, if there is one.
    pub first: Option<u64>,
    /// The last of them.
    pub last: Option<u64>,
    /// The reason, as text.
    pub why: String,
}

/// Replays a recording as far as possible, and gives `compare` each tick as
/// recorded and as replayed.
pub fn run<C: Controller>(
    replay: &mut Replay<C>,
    messages: impl IntoIterator<Item = MessageOf<C>>,
    mut compare: impl FnMut(&RecordOf<C>, &RecordOf<C>),
) -> Run {
    let mut run = Run::default();
    let mut began_ns = None;
    for message in messages {
        if let Some(unflown) = &mut run.unflown {
            unflown.count(tick_of::<C>(&message));
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
                let unflown = run.unflown.insert(NotReplayed {
                    ticks: 0,
                    first: None,
                    last: None,
                    why: cut.to_string(),
                });
                unflown.count(tick_of::<C>(message));
            }
        }
    }
    run
}

impl NotReplayed {
    fn count(&mut self, tick: Option<&Tick>) {
        if let Some(tick) = tick {
            self.ticks += 1;
            self.first.get_or_insert(tick.number);
            self.last = Some(tick.number);
        }
    }
}

const fn tick_of<C: Controller>(message: &MessageOf<C>) -> Option<&Tick> {
    match message {
        Message::Tick(record) => Some(&record.tick),
        Message::Event(_) => None,
    }
}
