//! A whole flight of the built-in aircraft in one call.

use std::ffi::CStr;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use fcc_core::flight::guidance::GuidanceConfig;
use fcc_core::flight::navigation::Estimate;
use fcc_core::flight::{Autopilot, AutopilotCommand, Measurements, Setpoints, Surfaces};
use fcc_core::framework::{Controller, Message, Sensor, State};
use fcc_flight::config::{Aircraft, Config};
use fcc_flight::flight::true_sample;
use fcc_runtime::{Link, LoopReport, Machine, Parts};
use fcc_sim::{SimConfig, Simulation, Truth, TruthHandle};
use fcc_telemetry::{
    FlightMessage, FlightRecord, FlightScore, PatternScorer, Realtime, TimingReport,
};
use fcc_timer::{ManualTimer, Timer, TimerError};
use pyo3::exceptions::{PyRuntimeWarning, PyValueError};
use pyo3::prelude::*;

use crate::arguments::within;
use crate::callbacks::{CallbackController, CallbackSensor, Raised};
use crate::config::configuration;
use crate::errors;
use crate::events::PyEvent;
use crate::json;
use crate::structured::Rows;

/// The legs that a flight has if nobody says how long it is to be.
const DEFAULT_LEGS: f64 = 8.0;
/// How long a flight without a pattern is if nobody says, s.
const DEFAULT_HOLD_S: f64 = 60.0;
/// The longest flight, s: a week.
const LONGEST_S: f64 = 604_800.0;
/// Ticks whose records and truths are kept at most: 3.5 GB of them.
const MOST_KEPT: u64 = 5_000_000;
/// How often an interruption from the keyboard is looked for.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Ticks between looks at the clock in lockstep.
const TICKS_PER_LOOK: u64 = 256;

const NOT_REAL_TIME: &CStr =
    c"a sensor or controller in Python stands in the loop: it is not real time, and for experiments only";

/// A flight that is over.
///
/// `records` and `truth` are structured arrays with a row for each tick
/// (dtypes `fcc.RECORD` and `fcc.TRUTH_RECORD`), empty if they were not to be kept;
/// `events` is what happened; `score` the flight's score by the truth, None
/// without a whole leg of a pattern; `timing` how well the loop kept time.
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
    score: Option<FlightScore>,
    timing: TimingReport,
}

#[pymethods]
impl PyFlight {
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
/// long as `fccd fly` takes: the hold and 8 legs, or 60 s without a pattern),
/// or when the loop stops. With `keep` False no records and truths are kept: a
/// row of both is some 730 bytes. The GIL is released meanwhile: several flights
/// run side by side in threads.
///
/// `sensor(time_s, measurements)` is called in every tick with what the
/// aircraft's sensors measured, and gives other `Measurements` or None.
/// `controller(time_s, measurements, setpoints, surfaces)` is called while
/// engaged with what the autopilot would do, and gives `Surfaces`. With one of
/// them the loop is not real time, and a `RuntimeWarning` says so. What they
/// raise ends the flight and is raised here.
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
        return Err(errors::FLIGHT.say(
            "the configuration has [x-plane]: fly() is for the built-in aircraft, and `fccd run` \
             for another",
        ));
    };
    let seconds = match seconds {
        Some(seconds) => within("seconds", seconds, 0.1, LONGEST_S)?,
        None => default_seconds(&config),
    };
    if sensor.is_some() || controller.is_some() {
        PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), NOT_REAL_TIME, 1)?;
    }
    let simulation = Simulation::new(&SimConfig::from(section))
        .map_err(|error| errors::FLIGHT.say(format_args!("the built-in aircraft: {error}")))?;
    let refused = |error: TimerError| errors::TIMER.say(error);
    let period = config.tick.period();
    let timer: Box<dyn Timer> = if real_time {
        config.tick.timer.build(period).map_err(refused)?
    } else {
        Box::new(ManualTimer::new(period).map_err(refused)?)
    };
    let raised = Raised::default();
    let mut aircraft: Box<dyn Sensor<Measurements>> = Box::new(simulation.sensor);
    if let Some(call) = sensor {
        let raised = raised.clone();
        aircraft = Box::new(CallbackSensor {
            sensor: aircraft,
            call,
            raised,
        });
    }
    let sensors = vec![aircraft];
    let ticks = ((section.engage_at_s + seconds) * config.tick.rate_hz).ceil() as u64;
    let log = Log::new(&config, &sensors, simulation.truth, ticks, keep)?;
    let autopilot = Autopilot::new(config.autopilot_config());
    let actuators: Vec<Box<dyn fcc_core::framework::Actuator<Surfaces>>> =
        vec![Box::new(simulation.actuator)];
    let flown = match controller {
        None => {
            let parts = Parts {
                timer,
                sensors,
                controller: autopilot,
                actuators,
            };
            conduct(py, parts, &config, &raised, log)
        }
        Some(call) => {
            let parts = Parts {
                timer,
                sensors,
                controller: CallbackController {
                    autopilot,
                    call,
                    raised: raised.clone(),
                },
                actuators,
            };
            conduct(py, parts, &config, &raised, log)
        }
    }?;
    flown.into_flight(py)
}

fn default_seconds(config: &Config) -> f64 {
    match config.autopilot_config().guidance {
        GuidanceConfig::Hold => DEFAULT_HOLD_S,
        GuidanceConfig::TimedPattern(pattern) => pattern.hold_s + DEFAULT_LEGS * pattern.leg_s,
    }
}

fn conduct<C>(
    py: Python<'_>,
    parts: Parts<C>,
    config: &Config,
    raised: &Raised,
    log: Log,
) -> PyResult<Flown>
where
    C: Controller<
            Measurements = Measurements,
            Estimate = Estimate,
            Setpoints = Setpoints,
            Outputs = Surfaces,
            Command = AutopilotCommand,
        >,
{
    let refused = |error: TimerError| errors::TIMER.say(error);
    let (machine, link) = Machine::new(parts, &config.loop_config()).map_err(refused)?;
    // Rings and boxed parts are for one thread at a time, which a lock shows.
    let flight = Mutex::new((machine, link, log));
    py.detach(move || {
        let (machine, link, log) = flight
            .into_inner()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        run(machine, link, raised, log)
    })
}

fn run<C>(
    mut machine: Machine<C>,
    mut link: Link<C>,
    raised: &Raised,
    mut log: Log,
) -> PyResult<Flown>
where
    C: Controller<
            Measurements = Measurements,
            Estimate = Estimate,
            Setpoints = Setpoints,
            Outputs = Surfaces,
            Command = AutopilotCommand,
        >,
{
    let began = Instant::now();
    let mut looked = began;
    machine.start().map_err(|error| errors::TIMER.say(error))?;
    let mut left = log.ticks;
    let mut state = machine.state();
    while left > 0 && state != State::Stopped {
        state = machine.step();
        left = left.saturating_sub(1 + machine.record().tick.missed);
        while let Some(message) = link.messages.receive() {
            log.take(&message);
        }
        if let Some(error) = raised.take() {
            return Err(error);
        }
        if left.is_multiple_of(TICKS_PER_LOOK) || looked.elapsed() > LOOK_EVERY {
            looked = Instant::now();
            listen()?;
        }
    }
    let took = began.elapsed();
    let seconds = machine.record().tick.number as f64 * log.period_s;
    let report = machine.finish();
    while let Some(message) = link.messages.receive() {
        log.take(&message);
    }
    Ok(Flown {
        log,
        state,
        seconds,
        took,
        report,
    })
}

#[expect(
    clippy::redundant_closure_for_method_calls,
    reason = "the method itself is for one lifetime, and not for any"
)]
fn listen() -> PyResult<()> {
    Python::attach(|py| py.check_signals())
}

/// What a flight leaves.
struct Flown {
    log: Log,
    state: State,
    seconds: f64,
    took: Duration,
    report: LoopReport,
}

impl Flown {
    fn into_flight(self, py: Python<'_>) -> PyResult<PyFlight> {
        let realtime = Realtime {
            policy: "not asked for".to_owned(),
            ..Realtime::default()
        };
        let log = self.log;
        // A leg that was not flown to its end has no figures, and the flight
        // no score.
        let score = log.scorer.and_then(|scorer| scorer.score());
        Ok(PyFlight {
            records: log.records.into_array(py)?.unbind(),
            truth: log.truths.into_array(py)?.unbind(),
            events: log.events,
            seconds: self.seconds,
            took_s: self.took.as_secs_f64(),
            state: self.state.to_string(),
            ending: self.report.ending.to_string(),
            score: score.filter(|score| !score.legs.is_empty()),
            timing: TimingReport::new(self.report.timer, &self.report.timing, realtime),
        })
    }
}

/// Keeps what a flight tells.
struct Log {
    sensors: Vec<String>,
    truth: TruthHandle,
    ticks: u64,
    period_s: f64,
    keep: bool,
    records: Rows<FlightRecord>,
    truths: Rows<Truth>,
    events: Vec<PyEvent>,
    scorer: Option<PatternScorer>,
}

impl Log {
    fn new(
        config: &Config,
        sensors: &[Box<dyn Sensor<Measurements>>],
        truth: TruthHandle,
        ticks: u64,
        keep: bool,
    ) -> PyResult<Self> {
        if keep && ticks > MOST_KEPT {
            return Err(PyValueError::new_err(format!(
                "{ticks} ticks are too many to keep: fly at most {MOST_KEPT}, or give keep=False"
            )));
        }
        let room = if keep { ticks as usize } else { 0 };
        Ok(Self {
            sensors: sensors.iter().map(|s| s.name().to_owned()).collect(),
            truth,
            ticks,
            period_s: config.tick.period().as_secs_f64(),
            keep,
            records: Rows::with_room(room),
            truths: Rows::with_room(room),
            events: Vec::new(),
            scorer: match config.autopilot_config().guidance {
                GuidanceConfig::TimedPattern(pattern) => Some(PatternScorer::new(pattern)),
                GuidanceConfig::Hold => None,
            },
        })
    }

    fn take(&mut self, message: &FlightMessage) {
        match message {
            Message::Tick(record) => {
                let truth = self.truth.get();
                if self.keep {
                    self.records.push(record);
                    self.truths.push(&truth);
                }
                if let Some(scorer) = &mut self.scorer {
                    let now_s = record.tick.number as f64 * self.period_s;
                    let sample = Some(true_sample(now_s, &truth));
                    let guidance = &record.setpoints.guidance;
                    scorer.take(record.state.state(), guidance, sample, sample);
                }
            }
            Message::Event(event) => {
                self.events.push(PyEvent::of::<Autopilot>(
                    event,
                    &self.sensors,
                    &self.sensors,
                ));
            }
        }
    }
}
