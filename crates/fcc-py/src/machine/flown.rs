//! What a machine told of a flight, kept until somebody wants it in a file.

use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use fcc_core::framework::Message;
use fcc_flight::config::Config;
use fcc_flight::flight::about;
use fcc_record::{About, Recorder, RecorderSettings, RecordingPace};
use fcc_telemetry::FlightMessage;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use super::python_io::{HandedOver, Held};
use crate::events::PyEvent;
use crate::structured::RecordRow;

/// Every record and event of a flight, in memory: 20 kB a second at 40 Hz.
pub(super) struct Flown {
    messages: Vec<FlightMessage>,
    /// How many were looked at for events.
    looked_at: usize,
    about: About,
}

impl Flown {
    /// Nothing yet, of a flight by this configuration.
    pub(super) fn new(config: &Config, as_given: &str, timer: &str) -> Self {
        let started_unix_ns = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map_or(0, |since| since.as_nanos() as u64);
        Self {
            messages: Vec::new(),
            looked_at: 0,
            about: About {
                timer: timer.to_owned(),
                sensors: vec![HandedOver::NAME.to_owned()],
                actuators: vec![Held::NAME.to_owned()],
                started_unix_ns,
                // The loop's clock begins at nought.
                clock_offset_ns: started_unix_ns as i64,
                ..about(config, Some(as_given.to_owned()))
            },
        }
    }

    pub(super) fn take(&mut self, message: &FlightMessage) {
        self.messages.push(*message);
    }

    /// The events since the last call.
    pub(super) fn events(&mut self) -> Vec<PyEvent> {
        let new = self.messages.get(self.looked_at..).unwrap_or_default();
        let events = new.iter().filter_map(|message| match message {
            Message::Tick(_) => None,
            Message::Event(event) => {
                let about = &self.about;
                Some(PyEvent::of(event, &about.sensors, &about.actuators))
            }
        });
        let events = events.collect();
        self.looked_at = self.messages.len();
        events
    }

    /// The record of every tick so far.
    pub(super) fn rows(&self) -> Vec<RecordRow> {
        let record = |message: &FlightMessage| match message {
            Message::Tick(record) => Some(RecordRow::from(record)),
            Message::Event(_) => None,
        };
        self.messages.iter().filter_map(record).collect()
    }

    /// Writes all of it into a folder, as the daemon records; gives the files.
    pub(super) fn record_to(
        &self,
        folder: PathBuf,
        aircraft: String,
        ending: &str,
    ) -> PyResult<Vec<PathBuf>> {
        let about = About {
            aircraft,
            ..self.about.clone()
        };
        let settings = RecorderSettings {
            pace: RecordingPace::Lockstep,
            ..RecorderSettings::new(folder)
        };
        let mut recorder = Recorder::start(about, settings)?;
        for message in &self.messages {
            recorder.take(message);
        }
        let (status, news) = recorder.finish(ending);
        if let Some(why) = status.stopped {
            return Err(PyOSError::new_err(why));
        }
        if let Some(trouble) = news.into_iter().find(|news| news.is_trouble) {
            return Err(PyOSError::new_err(trouble.text));
        }
        Ok(status.files)
    }
}
