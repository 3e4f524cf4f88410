//! A whole flight of the built-in aircraft in one call.

use std::ffi::CStr;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use fcc_core::framework::State;
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::{Aircraft, Config};
use fcc_flight::flight::{
    Access, Assembly, FlightTime, FlyError, Host, Impact, Length, Observer, Outcome, Pace, Plan,
    assemble,
};
use fcc_runtime::StopHandle;
use fcc_sim::{Truth, TruthHandle};
use fcc_telemetry::{FlightEvent, FlightRecord, FlightScore, TimingReport};
use fcc_timer::RealtimeRequest;
use pyo3::exceptions::{PyRuntimeWarning, PyValueError};
use pyo3::prelude::*;

use crate::arguments::within;
use crate::callbacks::{CallbackController, CallbackSensor, Raised};
use crate::config::configuration;
use crate::errors;
use crate::events::PyEvent;
use crate::json;
use crate::structured::Rows;

/// The longest flight, s: a week.
const LONGEST_S: f64 = 604_800.0;
/// Ticks whose records and truths are kept at most: 3.5 GB of them.
const MOST_KEPT: u64 = 5_000_000;
/// How often an interruption from the keyboard is checked for.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Polls between looks at the clock: in lockstep one follows each tick.
const POLLS_PER_LOOK: u64 = 256;

const NOT_REAL_TIME: &CStr =
    c"a sensor or controller in Python is in the loop: it is not real time, and for experiments only";

/// A finished flight.
///
/// `records` and `truth` are structured arrays with a row for each tick
/// (dtypes `fcc.RECORD` and `fcc.TRUTH_RECORD`), empty if they were not to be kept;
/// `events` are its events; `score` the flight's score by the truth, None
/// without a whole leg of a pattern; `timing` the loop's timing statistics.
///
/// >>> flight = fcc.fly(seconds=10.0)
/// >>> flight.state, flight.ending, len(flight.truth) == len(flight.records)
/// ('engaged', 'finished', True)
#[pyclass(name = "Flight", module = "fcc", frozen)]
pub(crate) struct PyFlight {
    #[pyo3(get)]
    records: Py<PyAny>,
    #[pyo3(get)]
    truth: Py<PyAny>,
    #[pyo3(get)]
    events: Vec<PyEvent>,
    /// How long it was flown, s.
    #[pyo3(get)]
    seconds: f64,
    /// How long that took, s.
    #[pyo3(get)]
    took_s: f64,
    /// The loop's state at the end.
    #[pyo3(get)]
    state: String,
    /// Why the loop ended, in words.
    #[pyo3(get)]
    ending: String,
    impact: Option<Impact>,
    score: Option<FlightScore>,
    timing: TimingReport,
}

impl PyFlight {
    fn new(
        py: Python<'_>,
        outcome: Outcome,
        log: Log,
        took: Duration,
        period_s: f64,
    ) -> PyResult<Self> {
        let last = log.last;
        Ok(Self {
            records: log.records.into_array(py)?.unbind(),
            truth: log.truths.into_array(py)?.unbind(),
            events: log.events,
            seconds: last.tick.number as f64 * period_s,
            took_s: took.as_secs_f64(),
            state: State::from(last.state).to_string(),
            ending: outcome.ending,
            impact: outcome.impact,
            // A flight without a complete leg has no score.
            score: outcome.flight.filter(|score| !score.legs.is_empty()),
            timing: outcome.timing,
        })
    }
}

#[pymethods]
impl PyFlight {
    /// Where and how the aircraft hit the ground, None if it did not: a dict
    /// with its units in the names.
    #[getter]
    fn impact<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.impact)
    }

    #[getter]
    fn score<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.score)
    }

    #[getter]
    fn timing<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.timing)
    }

    /// How many times faster than real time it was flown.
    #[getter]
    fn times_real_time(&self) -> f64 {
        self.seconds / self.took_s
    }

    fn __repr__(&self) -> String {
        format!(
            "<Flight of {:.1} s, {}, {} events>",
            self.seconds,
            self.state,
            self.events.len()
        )
    }
}

/// Flies the built-in aircraft by the configuration, in lockstep as fast as
/// the machine can, or in real time on the configured timer.
///
/// The flight ends `seconds` after the engage switch goes on (by default as
/// long as `fccd fly` takes: to the end of a plan, the hold and 8 legs of a pattern, or 60 s),
/// when the loop stops, or when the aircraft hits the ground (`Flight.impact`). One that never
/// engaged is an `EngageError` with the reason. With `keep` False no records and truths are kept: a
/// row of both is some 730 bytes. The GIL is released meanwhile: several flights
/// run side by side in threads.
///
/// `sensor(time_s, measurements)` is called in every tick with what the
/// aircraft's sensors measured, and gives other `Measurements` or None.
/// `controller(time_s, measurements, setpoints, surfaces)` is called while
/// engaged with what the autopilot would do, and gives `Surfaces`. With one of
/// them the loop is not real time, which a `RuntimeWarning` reports. An exception
/// of theirs ends the flight and is raised here.
///
/// >>> slow = '[autopilot]\nreference_airspeed_kt = 90.0'
/// >>> fcc.fly(slow, seconds=5.0).state
/// 'engaged'
#[pyfunction]
#[pyo3(signature = (config = None, *, seconds = None, sensor = None, controller = None,
                    real_time = false, keep = true))]
pub(crate) fn fly(
    py: Python<'_>,
    config: Option<&Bound<'_, PyAny>>,
    seconds: Option<f64>,
    sensor: Option<Py<PyAny>>,
    controller: Option<Py<PyAny>>,
    real_time: bool,
    keep: bool,
) -> PyResult<PyFlight> {
    let config = configuration(config)?;
    let Some(Aircraft::BuiltIn(section)) = config.aircraft() else {
        return Err(errors::FLIGHT.with(
            "the configuration has [x-plane]: fly() is for the built-in aircraft, and `fccd run` \
             for another",
        ));
    };
    let period_s = config.tick.period().as_secs_f64();
    let plan_s = config
        .plan_length_s()
        .filter(|_| seconds.is_none() && config.flies_plan());
    let seconds = match seconds {
        Some(seconds) => within("seconds", seconds, 0.1, LONGEST_S)?,
        // The switch counts from its second reading.
        None => period_s + plan_s.unwrap_or_else(|| config.guidance.default_length_s()),
    };
    let ticks = ((section.engages_at_s(config.navigation.method) + seconds) * config.tick.rate_hz)
        .ceil() as u64;
    if keep && ticks > MOST_KEPT {
        return Err(PyValueError::new_err(format!(
            "{ticks} ticks are too many to keep: fly at most {MOST_KEPT}, or give keep=False"
        )));
    }
    if sensor.is_some() || controller.is_some() {
        PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), NOT_REAL_TIME, 1)?;
    }
    let raised = Raised::default();
    let mut assembly = assemble(&config).map_err(|error| errors::FLIGHT.with(error))?;
    // Python asks the kernel for nothing.
    assembly.loop_config.realtime = RealtimeRequest::default();
    if let Some(call) = sensor {
        let with_callback = |sensor| CallbackSensor::boxed(sensor, call.clone_ref(py), &raised);
        assembly.sensors = assembly.sensors.into_iter().map(with_callback).collect();
    }
    if let Some(call) = controller {
        let raised = raised.clone();
        assembly.control = Some(Box::new(CallbackController { call, raised }));
    }
    let plan = Plan {
        pace: if real_time {
            Pace::RealTime
        } else {
            Pace::Lockstep
        },
        length: plan_s.map_or(Length::Ticks(ticks), Length::Flown),
    };
    let room = if keep { ticks as usize } else { 0 };
    let log = Log {
        truth: assembly.true_now.clone().filter(|_| keep),
        records: Rows::with_room(room),
        truths: Rows::with_room(room),
        ..Log::default()
    };
    let (outcome, log, took) = py.detach(move || conduct(assembly, config, plan, log, &raised))?;
    if !log.has_engaged {
        let mut texts = log.events.into_iter().map(|event| event.text);
        let refusal = texts.rfind(|text| text.starts_with("not engaged"));
        let why = refusal.unwrap_or_else(|| format!("not engaged: {}", outcome.ending));
        return Err(errors::ENGAGE.with(why));
    }
    PyFlight::new(py, outcome, log, took, period_s)
}

/// Flies to the end, without Python but for its callbacks.
fn conduct(
    mut assembly: Assembly,
    mut config: Config,
    plan: Plan,
    log: Log,
    raised: &Raised,
) -> PyResult<(Outcome, Log, Duration)> {
    // Only daemons are watched.
    config.telemetry.enabled = false;
    let log = Arc::new(Mutex::new(log));
    let mut interrupt = Interrupt::default();
    let mut observers = assembly.observers(&config, plan.pace, None);
    observers.push(Box::new(PythonObserver {
        log: Arc::clone(&log),
        interrupt: interrupt.clone(),
        raised: raised.clone(),
        looked: Instant::now(),
        polls: 0,
    }));
    let began = Instant::now();
    let flown = fcc_flight::flight::fly(assembly, &config.tick, plan, observers, &mut interrupt);
    let took = began.elapsed();
    if let Some(error) = raised.take() {
        return Err(error);
    }
    let outcome = flown.map_err(|error| match error {
        FlyError::Timer(error) => errors::TIMER.with(error),
        error => errors::FLIGHT.with(error),
    })?;
    let log = std::mem::take(&mut *lock(&log));
    Ok((outcome, log, took))
}

/// Stops the loop when Python raises: a callback, or an interruption from the
/// keyboard.
#[derive(Clone, Default)]
struct Interrupt(Arc<OnceLock<StopHandle>>);

impl Host for Interrupt {
    fn attach(&mut self, stop: &StopHandle) -> std::io::Result<()> {
        // There is one loop only.
        let _ = self.0.set(stop.clone());
        Ok(())
    }
}

/// The records, truths and events of a flight.
#[derive(Default)]
struct Log {
    /// None if nothing is kept.
    truth: Option<TruthHandle>,
    records: Rows<FlightRecord>,
    truths: Rows<Truth>,
    events: Vec<PyEvent>,
    last: FlightRecord,
    has_engaged: bool,
}

fn lock(log: &Mutex<Log>) -> MutexGuard<'_, Log> {
    log.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Collects the log, and looks for exceptions of Python.
struct PythonObserver {
    log: Arc<Mutex<Log>>,
    interrupt: Interrupt,
    raised: Raised,
    looked: Instant,
    polls: u64,
}

impl Observer<Autopilot> for PythonObserver {
    fn record(&mut self, record: &FlightRecord, _: &FlightTime) {
        let log = &mut *lock(&self.log);
        log.last = *record;
        log.has_engaged |= record.state == State::Engaged;
        if let Some(truth) = &log.truth {
            log.records.push(record);
            log.truths.push(&truth.get());
        }
    }

    fn event(&mut self, event: &FlightEvent, description: &str, _: &FlightTime) {
        let event = PyEvent::described(event, description.to_owned());
        lock(&self.log).events.push(event);
    }

    fn poll(&mut self, _: &mut Access<'_, fcc_fixed_wing::AutopilotCommand>) {
        self.polls += 1;
        if self.polls.is_multiple_of(POLLS_PER_LOOK) || self.looked.elapsed() > LOOK_EVERY {
            self.looked = Instant::now();
            self.raised.keep_signals();
        }
        if let (true, Some(stop)) = (self.raised.is_some(), self.interrupt.0.get()) {
            stop.stop();
        }
    }
}
