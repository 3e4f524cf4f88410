//! A recording, read into numpy.

use std::path::PathBuf;

use fcc_record::{About, AnyPlantMessage, Damage, End, Recording};
use fcc_telemetry::schema::RecordDescription;
use fcc_telemetry::schema::protobuf::RowDecoder;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

use super::frame;
#[cfg(feature = "flight")]
use crate::config::{PyConfig, refused};
use crate::errors;
use crate::events::PyEvent;
use crate::json;
use crate::structured::{array, columns, dtype_of};

/// The largest capacity that is allocated in advance: an hour at 40 Hz. A larger
/// count in a file is not trusted.
const ROOM: u64 = 144_000;

/// A recording of any plant, whole or cut off: facts about the run, its
/// records as a structured array, its events. The columns are those that the
/// file describes.
///
/// Opening reads its two ends; the first use of `records`, `events` or `cut`
/// reads all of it, with the GIL released. Raises `RecordingError` if a file
/// cannot be read or is not a recording.
///
/// >>> recording = fcc.Recording("recordings/flight.mcap")
/// >>> len(recording.records), recording.cut
/// (400, None)
#[pyclass(name = "Recording", module = "fcc", frozen)]
pub(crate) struct PyRecording {
    recording: Recording,
    described: RecordDescription,
    contents: PyOnceLock<Contents>,
}

struct Contents {
    records: Py<PyAny>,
    events: Vec<PyEvent>,
    cut: Option<String>,
    damages: Vec<Damage>,
}

/// The contents of a file.
struct Read {
    rows: Vec<u64>,
    events: Vec<PyEvent>,
    cut: Option<String>,
    damages: Vec<Damage>,
}

#[pymethods]
impl PyRecording {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let recording = py
            .detach(|| Recording::open(path))
            .map_err(|error| errors::RECORDING.with(error))?;
        let described = recording
            .columns()
            .cloned()
            .or_else(|| OWN_COLUMNS.map(|of| of()));
        Ok(Self {
            described: described.ok_or_else(|| {
                let path = recording.path().display();
                errors::RECORDING.with(format!("{path}: the description of its columns is damaged"))
            })?,
            recording,
            contents: PyOnceLock::new(),
        })
    }

    /// All records, oldest first, as a structured array (of a flight: `fcc.RECORD`): a row
    /// for each tick, a column for each number, with the unit at the end of its
    /// name. Instants are ns on the loop's clock, the smallest number meaning
    /// never; the value beside such a time means nothing.
    #[getter]
    fn records<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.contents(py)?.records.bind(py).clone())
    }

    /// The columns of the records by their names, each as a dict: unit, meaning,
    /// range, the names of codes, path in the record.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, &self.described)
    }

    /// The events, oldest first.
    #[getter]
    fn events(&self, py: Python<'_>) -> PyResult<Vec<PyEvent>> {
        Ok(self.contents(py)?.events.clone())
    }

    /// Where and why reading ended before the recording did; None for a whole
    /// one.
    #[getter]
    fn cut(&self, py: Python<'_>) -> PyResult<Option<String>> {
        Ok(self.contents(py)?.cut.clone())
    }

    /// The damage inside, each as a dict: bytes, reason, missing ticks. Empty for
    /// a whole one.
    #[getter]
    fn damages<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.contents(py)?.damages)
    }

    /// Facts about the flight: program, machine, loop, sensors.
    #[getter]
    fn about<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        about(py, self.recording.about())
    }

    /// The configuration that was flown, defaults included; of another plant it is
    /// a text, `about["config"]`.
    #[cfg(feature = "flight")]
    #[getter]
    fn config(&self) -> PyResult<PyConfig> {
        let name = format!("{}: config.toml", self.recording.path().display());
        fcc_flight::config::Config::parse(&self.recording.about().config, &name)
            .and_then(|given| PyConfig::of(given, &name))
            .map_err(|error| refused(&error))
    }

    /// The statistics at the end of the file; of one that is cut off, those of its
    /// contents.
    fn account<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let end = py
            .detach(|| self.recording.account())
            .map_err(|error| errors::RECORDING.with(error))?;
        account(py, &end)
    }

    /// Whether the file is finished; if not, see `recover`. For damage before its
    /// end see `damages`.
    #[getter]
    fn is_whole(&self) -> bool {
        self.recording.is_whole()
    }

    /// The path of the file.
    #[getter]
    fn path(&self) -> PathBuf {
        self.recording.path().to_owned()
    }

    /// The size of the file.
    #[getter]
    fn bytes(&self) -> u64 {
        self.recording.bytes()
    }

    /// All records as a `pandas.DataFrame`, the index being seconds since the
    /// first record; values that were never measured are NaN. Needs pandas.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        frame::of(
            self.contents(py)?.records.bind(py).as_any(),
            &self.described,
        )
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.contents(py)?.records.bind(py).len()
    }

    fn __repr__(&self) -> String {
        let path = self.recording.path().display().to_string();
        format!("Recording({path:?})")
    }
}

impl PyRecording {
    fn contents(&self, py: Python<'_>) -> PyResult<&Contents> {
        self.contents.get_or_try_init(py, || {
            let read = py.detach(|| self.read())?;
            let dtype = dtype_of(py, &self.described)?;
            Ok(Contents {
                records: array(py, read.rows, &dtype)?.unbind(),
                events: read.events,
                cut: read.cut,
                damages: read.damages,
            })
        })
    }

    fn read(&self) -> PyResult<Read> {
        let decoder = RowDecoder::new(&self.described);
        let ticks = self.recording.end().map_or(0, |end| end.ticks);
        let mut rows = Vec::with_capacity(ticks.min(ROOM) as usize * decoder.words());
        let mut events = Vec::new();
        let mut messages = self
            .recording
            .messages::<AnyPlantMessage>()
            .map_err(|error| errors::RECORDING.with(error))?;
        for message in &mut messages {
            match message {
                AnyPlantMessage::Record(record, message) => {
                    let begin = rows.len();
                    rows.resize(begin + decoder.words(), 0);
                    let row = rows.get_mut(begin..).unwrap_or_default();
                    decoder.decode(&message, row).map_err(|error| {
                        let path = self.recording.path().display();
                        let tick = record.tick.number;
                        let words = format!(
                            "{path}: the record of tick {tick} is not as the columns say: {error}"
                        );
                        errors::RECORDING.with(words)
                    })?;
                }
                AnyPlantMessage::Event(event, text) => {
                    events.push(PyEvent::described(&event, text));
                }
            }
        }
        Ok(Read {
            rows,
            events,
            cut: messages.cut().map(str::to_owned),
            damages: messages.damages().to_vec(),
        })
    }
}

/// The columns of this module's own plant, for a file whose description is
/// damaged.
const OWN_COLUMNS: Option<fn() -> RecordDescription> = {
    #[cfg(feature = "flight")]
    let own: Option<fn() -> _> = Some(RecordDescription::of::<fcc_telemetry::FlightRecord>);
    #[cfg(not(feature = "flight"))]
    let own = None;
    own
};

fn about<'py>(py: Python<'py>, about: &About) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("software", &about.software)?;
    dict.set_item("git_hash", &about.git_hash)?;
    dict.set_item("host", &about.host)?;
    dict.set_item("kernel", &about.kernel)?;
    dict.set_item("plant", &about.plant)?;
    dict.set_item("rate_hz", about.rate_hz)?;
    dict.set_item("timer", &about.timer)?;
    dict.set_item("sensors", &about.sensors)?;
    dict.set_item("actuators", &about.actuators)?;
    dict.set_item("policy", &about.realtime.policy)?;
    dict.set_item("priority", about.realtime.priority)?;
    dict.set_item("memory_locked", about.realtime.memory_locked)?;
    let denied = about.realtime.refused.iter().map(ToString::to_string);
    dict.set_item("refused", denied.collect::<Vec<_>>())?;
    dict.set_item("started", about.started())?;
    dict.set_item("started_unix_ns", about.started_unix_ns)?;
    dict.set_item("clock_offset_ns", about.clock_offset_ns)?;
    dict.set_item("config_as_given", &about.config_as_given)?;
    dict.set_item("config", &about.config)?;
    dict.set_item("config_sha256", about.config_sha256())?;
    dict.set_item("part", about.part)?;
    Ok(dict)
}

fn account<'py>(py: Python<'py>, end: &End) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("ending", &end.ending)?;
    dict.set_item("ticks", end.ticks)?;
    dict.set_item("first_tick", end.first_tick)?;
    dict.set_item("last_tick", end.last_tick)?;
    dict.set_item("missed", end.missed)?;
    dict.set_item("duration_ns", end.duration_ns)?;
    dict.set_item("worst_lateness_ns", end.worst_lateness_ns)?;
    dict.set_item("state", &end.state)?;
    dict.set_item("not_recorded", end.not_recorded)?;
    Ok(dict)
}
