//! A loop on this machine, live.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use fcc_core::framework::Time;
use fcc_live::{Event, EventCode, Info, RecorderState, RowWatcher, Status, WatchError};
use fcc_telemetry::Instance;
use numpy::PyArrayDescr;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::instance;
use crate::arguments::within;
use crate::errors;
use crate::events::{PyEvent, kind_name, seconds};
use crate::structured::{array, columns, dtype_of};

/// The interval between reads while it waits.
const LOOK_EVERY: Duration = Duration::from_millis(2);
/// How often it checks that the daemon runs, while nothing arrives.
const ASK_EVERY: Duration = Duration::from_millis(250);
/// How often it checks for an interruption from the keyboard.
const SIGNALS_EVERY: Duration = Duration::from_millis(50);

/// Watches a daemon, or the loop of any other plant, on this machine, by its
/// instance's name. The newest record and the last 64 events are there at once.
///
/// Raises `TelemetryError` if there is no such daemon, if it is of another
/// version, and when it has ended. Iterating gives each record as it comes, as
/// a row (of a flight: of `fcc.RECORD`), and raises `TelemetryError` when the
/// daemon ends.
///
/// >>> int(fcc.Watcher("lab").latest()["tick"]) > 0
/// True
#[pyclass(name = "Watcher", module = "fcc")]
pub(crate) struct PyWatcher {
    watcher: Mutex<RowWatcher>,
    dtype: Py<PyArrayDescr>,
    instance: Instance,
}

fn refused(error: &WatchError) -> PyErr {
    errors::TELEMETRY.with(error)
}

#[pymethods]
impl PyWatcher {
    #[new]
    #[pyo3(signature = (instance = "fccd"))]
    fn new(py: Python<'_>, instance: &str) -> PyResult<Self> {
        let instance = self::instance(instance)?;
        let watcher = py
            .detach(|| RowWatcher::open(&instance))
            .map_err(|error| refused(&error))?;
        Ok(Self {
            dtype: dtype_of(py, watcher.columns())?.unbind(),
            watcher: Mutex::new(watcher),
            instance,
        })
    }

    /// The newest record, as a row; older ones are skipped. Waits up to `timeout_s` (0 to 3,600) for one that was not given
    /// yet, and gives None if none comes.
    #[pyo3(signature = (timeout_s = 1.0))]
    fn latest<'py>(&self, py: Python<'py>, timeout_s: f64) -> PyResult<Option<Bound<'py, PyAny>>> {
        let patience = Duration::from_secs_f64(within("timeout_s", timeout_s, 0.0, 3_600.0)?);
        let found = self.wait(py, Some(patience), |watcher| {
            watcher.newest(<[u64]>::to_vec)
        })?;
        found.map(|words| self.row(py, words)).transpose()
    }

    /// All records since the last call, oldest first, as a structured array. Of
    /// more than 1,024 the oldest are dropped.
    fn records<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut rows = Vec::new();
        let read = py.detach(|| {
            let mut watcher = self.watcher();
            while let Some(()) = watcher.next(|row| rows.extend_from_slice(row))? {}
            Ok(())
        });
        self.must_live(py, read, rows.is_empty())?;
        array(py, rows, self.dtype.bind(py))
    }

    /// All events since the last call, oldest first.
    fn events(&self, py: Python<'_>) -> PyResult<Vec<PyEvent>> {
        let mut events = Vec::new();
        let read = py.detach(|| {
            let mut watcher = self.watcher();
            while let Some(event) = watcher.next_event()? {
                events.push(event_of(&event));
            }
            Ok(())
        });
        self.must_live(py, read, events.is_empty())?;
        Ok(events)
    }

    /// The status of the run, as a dict: the newest one, of which one comes
    /// each second. Waits up to `timeout_s` (0 to 3,600) for one that was not
    /// given yet, and gives None if none comes.
    #[pyo3(signature = (timeout_s = 1.5))]
    fn status<'py>(&self, py: Python<'py>, timeout_s: f64) -> PyResult<Option<Bound<'py, PyDict>>> {
        let patience = Duration::from_secs_f64(within("timeout_s", timeout_s, 0.0, 3_600.0)?);
        let found = self.wait(py, Some(patience), RowWatcher::latest_status)?;
        found.map(|status| status_dict(py, &status)).transpose()
    }

    /// The columns of the records by their names, each as a dict: unit, meaning,
    /// range, the names of codes, path in the record.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, self.watcher().columns())
    }

    /// The daemon, as a dict: program, process, loop.
    #[getter]
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        info_dict(py, self.watcher().info())
    }

    /// Whether the daemon still publishes.
    #[getter]
    fn is_alive(&self, py: Python<'_>) -> bool {
        py.detach(|| self.watcher().is_alive())
    }

    fn __iter__(this: PyRef<'_, Self>) -> PyRef<'_, Self> {
        this
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let found = self.wait(py, None, |watcher| watcher.next(<[u64]>::to_vec))?;
        found.map(|words| self.row(py, words)).transpose()
    }

    fn __repr__(&self) -> String {
        format!("Watcher({:?})", self.instance.to_string())
    }
}

impl PyWatcher {
    fn watcher(&self) -> MutexGuard<'_, RowWatcher> {
        self.watcher.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One record as numpy's scalar.
    fn row<'py>(&self, py: Python<'py>, words: Vec<u64>) -> PyResult<Bound<'py, PyAny>> {
        array(py, words, self.dtype.bind(py))?.get_item(0)
    }

    /// Reads until there is something, the time is over or the daemon has ended.
    fn wait<T: Send>(
        &self,
        py: Python<'_>,
        patience: Option<Duration>,
        look: impl Fn(&mut RowWatcher) -> Result<Option<T>, WatchError> + Sync,
    ) -> PyResult<Option<T>> {
        let began = Instant::now();
        let mut asked = began;
        loop {
            let checked = Instant::now();
            let found = py.detach(|| -> Result<Option<T>, WatchError> {
                loop {
                    let found = look(&mut self.watcher())?;
                    let enough = patience.is_some_and(|patience| began.elapsed() >= patience);
                    if found.is_some() || enough || checked.elapsed() >= SIGNALS_EVERY {
                        return Ok(found);
                    }
                    if asked.elapsed() >= ASK_EVERY {
                        asked = Instant::now();
                        let mut watcher = self.watcher();
                        if !watcher.is_alive() {
                            // What came last came before the end.
                            return match look(&mut watcher)? {
                                Some(found) => Ok(Some(found)),
                                None => Err(WatchError::Ended(self.instance.clone())),
                            };
                        }
                    }
                    std::thread::sleep(LOOK_EVERY);
                }
            });
            py.check_signals()?;
            match found.map_err(|error| refused(&error))? {
                Some(found) => return Ok(Some(found)),
                None if patience.is_some_and(|patience| began.elapsed() >= patience) => {
                    self.must_live(py, Ok(()), true)?;
                    return Ok(None);
                }
                None => {}
            }
        }
    }

    /// Raises errors, and the end of the daemon once nothing more is there.
    fn must_live(
        &self,
        py: Python<'_>,
        read: Result<(), WatchError>,
        nothing: bool,
    ) -> PyResult<()> {
        read.map_err(|error| refused(&error))?;
        if nothing && !py.detach(|| self.watcher().is_alive()) {
            return Err(refused(&WatchError::Ended(self.instance.clone())));
        }
        Ok(())
    }
}

fn event_of(event: &Event) -> PyEvent {
    let time = Time::from_nanos(event.time_ns);
    PyEvent {
        tick: event.tick,
        time_s: seconds(time),
        time_ns: (!time.is_never()).then_some(event.time_ns),
        kind: u8::try_from(event.code)
            .ok()
            .and_then(EventCode::from_number)
            .map_or_else(|| "other".to_owned(), |code| kind_name(&code)),
        text: event.text.as_str().to_owned(),
    }
}

fn info_dict<'py>(py: Python<'py>, info: &Info) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("software", info.software.as_str())?;
    dict.set_item("commit", info.commit.as_str())?;
    dict.set_item("process_id", info.process_id)?;
    dict.set_item("started_unix_ns", info.started_unix_ns)?;
    dict.set_item("started_ns", info.started_ns)?;
    dict.set_item("rate_hz", info.rate_hz)?;
    dict.set_item("timer", info.timer.as_str())?;
    dict.set_item("policy", info.policy.as_str())?;
    dict.set_item("priority", info.priority)?;
    dict.set_item("memory_locked", info.memory_locked != 0)?;
    dict.set_item("plant", info.plant.as_str())?;
    dict.set_item("layout", info.layout)?;
    let refusals = info.refusals.as_str();
    dict.set_item("refused", refusals.lines().collect::<Vec<_>>())?;
    Ok(dict)
}

fn status_dict<'py>(py: Python<'py>, status: &Status) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("time_ns", status.time_ns)?;
    dict.set_item("ticks", status.ticks)?;
    dict.set_item("missed", status.missed)?;
    dict.set_item("lateness_p50_ns", status.lateness_p50_ns)?;
    dict.set_item("lateness_p99_ns", status.lateness_p99_ns)?;
    dict.set_item("lateness_p99_9_ns", status.lateness_p99_9_ns)?;
    dict.set_item("lateness_max_ns", status.lateness_max_ns)?;
    dict.set_item("not_published", status.not_published)?;
    dict.set_item("watchers", status.watchers)?;
    let recorder = match status.recorder() {
        RecorderState::Off => "off",
        RecorderState::Recording => "recording",
        RecorderState::Stopped => "stopped",
    };
    dict.set_item("recorder", recorder)?;
    dict.set_item("recorded", status.recorded)?;
    dict.set_item("not_recorded", status.not_recorded)?;
    dict.set_item("recording_bytes", status.recording_bytes)?;
    dict.set_item("recording", status.recording.as_str())?;
    Ok(dict)
}
