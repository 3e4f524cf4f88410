//! The daemon's loop, one call one tick: its states, its failsafe and its
//! recording, with sensors that say what Python hands over.

mod flown;
mod python_io;

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use fcc_core::flight::{Autopilot, AutopilotCommand, Surfaces};
use fcc_core::framework::{Controller as _, LoopCommand, State, Switch};
use fcc_runtime::{Link, Machine, Parts};
use fcc_timer::ManualTimer;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyString;
use rtrb::Producer;

use crate::autopilot::checked_commands;
use crate::config::{configuration, refused};
use crate::errors;
use crate::events::PyEvent;
use crate::stepped::names;
use crate::structured::{self, RecordRow};
use crate::values::{PyEstimate, PyMeasurements, PySetpoints, PySurfaces, checked_surfaces};
use flown::Flown;
use python_io::{HandedOver, Held, Missing, Said};

/// The daemon's loop, one call one tick: the very machine that `fccd` runs, on
/// a clock that stands still between calls.
///
/// `config` is a `Config`, or the text of a configuration file as `fccd` reads
/// it; what it says of an aircraft does not matter here: Python is the aircraft.
#[pyclass(name = "Machine", module = "fcc")]
pub(crate) struct PyMachine {
    // A loop's ends are for one thread at a time, and so is `&mut self`.
    stepped: Mutex<Stepped>,
    period_s: f64,
    /// What airspeeds may be commanded.
    airspeeds_mps: RangeInclusive<f64>,
}

struct Stepped {
    machine: Machine<Autopilot>,
    link: Link<Autopilot>,
    hand_over: Producer<Said>,
    held: Arc<AtomicBool>,
    flown: Flown,
    /// When the next tick is due, s.
    next_s: f64,
}

#[pymethods]
impl PyMachine {
    #[new]
    #[pyo3(signature = (config = None))]
    fn new(config: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let parsed = configuration(config)?;
        let as_given = as_given(config)?;
        let refused = |error: fcc_timer::TimerError| errors::TIMER.say(error);
        let timer = ManualTimer::new(parsed.tick.period()).map_err(refused)?;
        let (hand_over, sensor) = HandedOver::new();
        let (held, actuator) = Held::new();
        let autopilot = parsed.autopilot_config();
        let airspeeds_mps = autopilot.envelope.allowed_airspeeds();
        let parts = Parts {
            timer: Box::new(timer),
            sensors: vec![Box::new(sensor)],
            controller: Autopilot::new(autopilot),
            actuators: vec![Box::new(actuator)],
        };
        let (mut machine, link) = Machine::new(parts, &parsed.loop_config()).map_err(refused)?;
        machine.start().map_err(refused)?;
        let period_s = parsed.tick.period().as_secs_f64();
        Ok(Self {
            stepped: Mutex::new(Stepped {
                machine,
                link,
                hand_over,
                held,
                flown: Flown::new(&parsed, &as_given, "manual"),
                next_s: period_s,
            }),
            period_s,
            airspeeds_mps,
        })
    }

    /// One tick: gives the surfaces to set, or `None` if the loop sends none,
    /// because the controls are somebody else's.
    ///
    /// `measurements` is what the sensors say; `None` if nothing comes at all.
    /// `missing` names the sensors that say nothing in this tick: attitude,
    /// heading, `body_rates`, `specific_force`, airspeed, altitude. `standing`
    /// is where the controls stand: throttle 0..1, elevator, aileron and rudder
    /// -1..1, as `Surfaces` or as four numbers; `None` if the aircraft does not
    /// tell. `switch` is the engage
    /// switch; `None` if there is none.
    #[pyo3(signature = (measurements = None, *, missing = Vec::new(), standing = None,
                        switch = None))]
    fn step(
        &mut self,
        measurements: Option<&PyMeasurements>,
        missing: Vec<String>,
        standing: Option<&Bound<'_, PyAny>>,
        switch: Option<bool>,
    ) -> PyResult<Option<PySurfaces>> {
        let missing = Missing::named(missing)?;
        let standing = standing.map(surfaces).transpose()?;
        let period_s = self.period_s;
        let stepped = self.stepped();
        if let Some(measurements) = measurements {
            let said = Said {
                measurements: *measurements,
                missing,
                standing,
                switch: switch.map(|on| if on { Switch::On } else { Switch::Off }),
                plant_time_s: stepped.next_s,
            };
            // Full only once the loop is over and reads no more.
            let _ = stepped.hand_over.push(said);
        }
        stepped.next_s += period_s;
        stepped.machine.step();
        stepped.fetch();
        let record = stepped.machine.record();
        Ok(record.sent.then(|| record.outputs.into()))
    }

    /// Commands the loop to take over in the next tick, if nothing blocks it.
    fn engage(&mut self) -> PyResult<()> {
        self.stepped().send(LoopCommand::Engage)
    }

    /// Commands the loop to let go in the next tick.
    fn disengage(&mut self) -> PyResult<()> {
        self.stepped().send(LoopCommand::Disengage)
    }

    /// Commands the loop to let go and end in the next tick.
    fn stop(&mut self) -> PyResult<()> {
        self.stepped().send(LoopCommand::Stop)
    }

    /// Commands another airspeed (m/s), heading (rad) or altitude (m); ends a
    /// pattern.
    #[pyo3(signature = (*, airspeed_mps = None, heading_rad = None, altitude_m = None))]
    fn command(
        &mut self,
        airspeed_mps: Option<f64>,
        heading_rad: Option<f64>,
        altitude_m: Option<f64>,
    ) -> PyResult<()> {
        let allowed = self.airspeeds_mps.clone();
        for command in checked_commands(airspeed_mps, heading_rad, altitude_m, &allowed)? {
            self.stepped().send(LoopCommand::Controller(command))?;
        }
        Ok(())
    }

    /// What happened since the last call.
    fn events(&mut self) -> Vec<PyEvent> {
        self.stepped().flown.events()
    }

    /// The records of all ticks so far, as a structured array (`fcc.RECORD`).
    fn records<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<RecordRow>> {
        structured::records(py, self.stepped().flown.rows())
    }

    /// Writes every tick and event so far into `folder`, as the daemon records;
    /// gives the files. `aircraft` says what flew, `ending` why it is over.
    ///
    /// Raises `OSError` if the folder cannot be written to.
    #[pyo3(signature = (folder, *, aircraft = "lockstep", ending = "recorded so far"))]
    fn record_to(
        &mut self,
        py: Python<'_>,
        folder: PathBuf,
        aircraft: &str,
        ending: &str,
    ) -> PyResult<Vec<PathBuf>> {
        let flown = &self.stepped().flown;
        py.detach(|| flown.record_to(folder, aircraft.to_owned(), ending))
    }

    /// standby, engaged, failsafe or stopped.
    #[getter]
    fn state(&mut self) -> String {
        self.stepped().machine.state().to_string()
    }

    /// Why the loop may not engage, in words; empty while engaged.
    #[getter]
    fn engage_inhibits(&mut self) -> Vec<&'static str> {
        names(self.stepped().machine.record().engage_inhibits)
    }

    /// What makes going on unsafe, in words; empty in standby.
    #[getter]
    fn faults(&mut self) -> Vec<&'static str> {
        names(self.stepped().machine.record().faults)
    }

    /// Whether the loop holds the controls.
    #[getter]
    fn holds_control(&mut self) -> bool {
        self.stepped().held.load(Ordering::Relaxed)
    }

    /// The present set points.
    #[getter]
    fn setpoints(&mut self) -> PySetpoints {
        self.stepped().machine.record().setpoints.into()
    }

    /// What navigation makes of the measurements.
    #[getter]
    fn estimate(&mut self) -> PyEstimate {
        self.stepped().machine.controller().estimated().into()
    }

    /// The number of the last tick; 0 before the first.
    #[getter]
    fn tick(&mut self) -> u64 {
        self.stepped().machine.record().tick.number
    }

    /// The loop's clock at the last tick, s.
    #[getter]
    fn time_s(&mut self) -> f64 {
        let woke = self.stepped().machine.record().tick.woke;
        woke.as_nanos().max(0) as f64 * 1e-9
    }

    /// Time from a tick to the next, s.
    #[getter]
    const fn period_s(&self) -> f64 {
        self.period_s
    }
}

impl PyMachine {
    fn stepped(&mut self) -> &mut Stepped {
        let stepped = self.stepped.get_mut();
        stepped.unwrap_or_else(PoisonError::into_inner)
    }
}

impl Stepped {
    fn send(&mut self, command: LoopCommand<AutopilotCommand>) -> PyResult<()> {
        if self.machine.state() == State::Stopped {
            return Err(errors::ENGAGE
                .say("the loop has stopped and takes no commands: make another Machine"));
        }
        let sent = self.link.commands.send(command);
        sent.map_err(|full| errors::ENGAGE.say(full))
    }

    fn fetch(&mut self) {
        while let Some(message) = self.link.messages.receive() {
            self.flown.take(&message);
        }
    }
}

/// Where the controls stand, as `Surfaces` or as four numbers.
fn surfaces(standing: &Bound<'_, PyAny>) -> PyResult<Surfaces> {
    if let Ok(surfaces) = standing.cast::<PySurfaces>() {
        return Ok(surfaces.get().to_core());
    }
    let (throttle, elevator, aileron, rudder) = standing.extract()?;
    checked_surfaces(Surfaces {
        throttle,
        elevator,
        aileron,
        rudder,
    })
}

/// The text of a configuration, as a recording keeps it.
fn as_given(config: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
    match config.map(|config| config.cast::<PyString>()) {
        Some(Ok(text)) => Ok(text.to_str()?.to_owned()),
        _ => configuration(config)?
            .to_toml()
            .map_err(|error| refused(&error)),
    }
}
