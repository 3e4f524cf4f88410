//! The loop of any controller, one call per tick.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use fcc_core::framework::{Controller, Flags, LoopCommand, Message, MessageOf, RecordOf, State};
use fcc_record::{About, Document, Recorded, RecorderOf, RecorderSettings, RecordingPace};
use fcc_runtime::{Link, LoopConfig, Machine, Parts};
use fcc_timer::{ManualTimer, TimerError};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use rtrb::Producer;

use super::python_io::{HeldFlag, QueuedSensor};
use crate::errors;
use crate::events::PyEvent;
use crate::structured::Rows;

/// The loop of a controller on a clock that advances by one period per tick, with
/// every record and event kept: 20 kB a second for an aircraft at 40 Hz.
pub struct Lockstep<C: Recorded> {
    machine: Machine<C>,
    link: Link<C>,
    samples: Producer<C::Measurements>,
    held: Arc<AtomicBool>,
    period_s: f64,
    /// When the next tick is due, s.
    next_s: f64,
    messages: Vec<MessageOf<C>>,
    /// How many messages were searched for events.
    searched: usize,
    about: About,
}

impl<C: Recorded> Lockstep<C> {
    /// The loop of a controller; `about` is completed for its recording.
    ///
    /// # Errors
    /// When there is no timer of this period.
    pub fn new(
        controller: C,
        period: Duration,
        config: &LoopConfig,
        about: About,
    ) -> PyResult<Self> {
        let refused = |error: TimerError| errors::TIMER.with(error);
        let (samples, sensor) = QueuedSensor::new();
        let (held, actuator) = HeldFlag::new();
        let parts = Parts {
            timer: Box::new(ManualTimer::new(period).map_err(refused)?),
            sensors: vec![Box::new(sensor)],
            controller,
            actuators: vec![Box::new(actuator)],
        };
        let (mut machine, link) = Machine::new(parts, config).map_err(refused)?;
        machine.start().map_err(refused)?;
        let started_unix_ns = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map_or(0, |since| since.as_nanos() as u64);
        Ok(Self {
            machine,
            link,
            samples,
            held,
            period_s: period.as_secs_f64(),
            next_s: period.as_secs_f64(),
            messages: Vec::new(),
            searched: 0,
            about: About {
                rate_hz: 1.0 / period.as_secs_f64(),
                timer: "manual".to_owned(),
                sensors: vec![super::python_io::NAME.to_owned()],
                actuators: vec![super::python_io::NAME.to_owned()],
                started_unix_ns,
                // The loop's clock begins at 0.
                clock_offset_ns: started_unix_ns as i64,
                ..about
            },
        })
    }

    /// One tick; returns the outputs, if the loop sends any. Readings of the
    /// sample that were never taken are missing; without a sample the sensor is
    /// silent.
    pub fn step(&mut self, sample: Option<C::Measurements>) -> Option<C::Outputs> {
        if let Some(sample) = sample {
            // Full only once the loop has ended and reads no more.
            let _ = self.samples.push(sample);
        }
        self.machine.step();
        self.next_s += self.period_s;
        while let Some(message) = self.link.messages.receive() {
            self.messages.push(message);
        }
        let record = self.machine.record();
        record.sent.then_some(record.outputs)
    }

    /// Keeps a document for the recording.
    pub fn keep(&mut self, document: Document) {
        if !self.about.documents.contains(&document) {
            self.about.documents.push(document);
        }
    }

    /// Sends a command, which the next tick executes.
    ///
    /// # Errors
    /// When the loop has stopped, or too many commands wait.
    pub fn send(&mut self, command: LoopCommand<C::Command>) -> PyResult<()> {
        if self.machine.state() == State::Stopped {
            return Err(errors::ENGAGE
                .with("the loop has stopped and takes no commands: make another Machine"));
        }
        let sent = self.link.commands.send(command);
        sent.map_err(|full| errors::ENGAGE.with(full))
    }

    /// The events since the last call.
    pub fn events(&mut self) -> Vec<PyEvent> {
        let new = self.messages.get(self.searched..).unwrap_or_default();
        let events = new.iter().filter_map(|message| match message {
            Message::Tick(_) => None,
            Message::Event(event) => {
                let about = &self.about;
                Some(PyEvent::of::<C>(event, &about.sensors, &about.actuators))
            }
        });
        let events = events.collect();
        self.searched = self.messages.len();
        events
    }

    /// The record of every tick so far.
    pub fn records(&self) -> Rows<RecordOf<C>> {
        let records = self.messages.iter().filter_map(|message| match message {
            Message::Tick(record) => Some(record),
            Message::Event(_) => None,
        });
        records.collect()
    }

    /// Writes all of it into a folder, as the daemon records, and returns the
    /// files.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn record_to(&self, folder: PathBuf, plant: &str, ending: &str) -> PyResult<Vec<PathBuf>> {
        let about = About {
            plant: plant.to_owned(),
            ..self.about.clone()
        };
        let settings = RecorderSettings {
            pace: RecordingPace::Lockstep,
            ..RecorderSettings::new(folder)
        };
        let mut recorder = RecorderOf::<C>::start(about, settings)?;
        for message in &self.messages {
            recorder.take(message);
        }
        let (status, reports) = recorder.finish(ending);
        let trouble = reports.into_iter().find(|report| report.is_trouble);
        match status.stopped.or(trouble.map(|trouble| trouble.text)) {
            Some(why) => Err(PyOSError::new_err(why)),
            None => Ok(status.files),
        }
    }

    /// The state of the loop.
    pub fn state(&self) -> State {
        self.machine.state()
    }

    /// Whether the loop holds the actuator.
    pub fn is_held(&self) -> bool {
        self.held.load(Ordering::Relaxed)
    }

    /// The record of the last tick.
    pub fn record(&self) -> &RecordOf<C> {
        self.machine.record()
    }

    /// The present estimate.
    pub fn estimated(&self) -> C::Estimate {
        self.machine.controller().estimated()
    }

    /// The controller.
    pub const fn controller(&self) -> &C {
        self.machine.controller()
    }

    /// When the next tick is due, s on a clock that begins at 0.
    pub const fn next_s(&self) -> f64 {
        self.next_s
    }

    /// Time from a tick to the next, s.
    pub const fn period_s(&self) -> f64 {
        self.period_s
    }
}

/// Conditions of a controller as text.
pub fn conditions<C: Controller>(flags: Flags) -> Vec<&'static str> {
    flags.iter().map(C::flag_name).collect()
}
