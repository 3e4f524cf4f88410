//! The daemon's loop in lockstep with a plant in Python: one call, one tick.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use fcc_core::flight::{Autopilot, Measurements, Order as Command, Surfaces};
use fcc_core::framework::{
    Actuator, ActuatorFault, Controller, Message, Order, Sensor, SensorFault, State, Switch, Tick,
    Time,
};
use fcc_runtime::{Link, Machine, Parts};
use fcc_timer::{Expiry, Timer, TimerError};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rtrb::{Consumer, Producer, RingBuffer};

use crate::autopilot::checked_orders;
use crate::config::configuration;
use crate::errors;
use crate::events::PyEvent;
use crate::stepped::names;
use crate::structured::{self, RecordRow};
use crate::values::{
    Measured, PyEstimate, PyMeasurements, PySetpoints, PySurfaces, checked_surfaces,
};

/// Missed periods before one tick: a minute at the fastest rate.
const MOST_MISSED: u64 = 120_000;

/// What events call the caller.
const CALLER: &str = "Python";

/// The daemon's loop in lockstep with a plant of your own: states (standby,
/// engaged, failsafe, stopped), engage switch, orders, failsafe and events are
/// those of `fccd`, and a tick is a call. Its rate is the configuration's.
#[pyclass(name = "Loop", module = "fcc")]
pub(crate) struct PyLoop {
    inner: Mutex<Inner>,
}

struct Inner {
    machine: Machine<Autopilot>,
    link: Link<Autopilot>,
    measured: Producer<Measurements>,
    period_ns: i64,
    number: u64,
    /// Where the controls stand, once that is known.
    standing: Option<Surfaces>,
    rows: Vec<RecordRow>,
    events: Vec<PyEvent>,
}

impl PyLoop {
    /// A part that panicked is stopped and released: what is left is sound.
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn send(&self, order: Order<Command>) -> PyResult<()> {
        self.inner()
            .link
            .orders
            .send(order)
            .map_err(|error| errors::ORDER.say(error))
    }
}

#[pymethods]
impl PyLoop {
    #[new]
    #[pyo3(signature = (config = None))]
    fn new(config: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let config = configuration(config)?;
        let period = config.tick.period();
        let (measured, handed) = RingBuffer::new(1);
        let parts = Parts {
            timer: Box::new(CalledTimes { period }),
            sensors: vec![Box::new(Handed { handed })],
            controller: Autopilot::new(config.autopilot_config()),
            actuators: vec![Box::new(Nothing)],
        };
        let refused = |error: TimerError| errors::TIMER.say(error);
        let (mut machine, link) = Machine::new(parts, &config.loop_config()).map_err(refused)?;
        machine.start().map_err(refused)?;
        Ok(Self {
            inner: Mutex::new(Inner {
                machine,
                link,
                measured,
                period_ns: period.as_nanos() as i64,
                number: 0,
                standing: None,
                rows: Vec::new(),
                events: Vec::new(),
            }),
        })
    }

    /// One tick, a period after the last: the surfaces that go to the aircraft,
    /// or None if the loop does not hold the controls.
    ///
    /// `measurements` None is sensors that say nothing: readings grow old.
    /// `switch` is the engage switch, None where there is none. `standing` is
    /// where the controls stand, by default what was sent last; before that it
    /// is not known, and the autopilot takes over with its trim throttle. `missed` are
    /// periods that pass unserved before this tick.
    #[pyo3(signature = (measurements, *, switch = None, standing = None, missed = 0))]
    fn step(
        &self,
        measurements: Option<&PyMeasurements>,
        switch: Option<bool>,
        standing: Option<&PySurfaces>,
        missed: u64,
    ) -> PyResult<Option<PySurfaces>> {
        if missed > MOST_MISSED {
            return Err(PyValueError::new_err(format!(
                "missed is {missed}: choose 0 to {MOST_MISSED}"
            )));
        }
        let mut inner = self.inner();
        if let Some(standing) = standing {
            inner.standing = Some(checked_surfaces(standing.to_core())?);
        }
        Ok(inner
            .step(measurements, switch, missed)
            .map(PySurfaces::from))
    }

    /// Orders the loop to engage, in the next tick.
    fn engage(&self) -> PyResult<()> {
        self.send(Order::Engage)
    }

    /// Orders the loop to disengage, in the next tick.
    fn disengage(&self) -> PyResult<()> {
        self.send(Order::Disengage)
    }

    /// Orders the loop to stop, in the next tick.
    fn stop(&self) -> PyResult<()> {
        self.send(Order::Stop)
    }

    /// Orders another airspeed (m/s, 5 to 340), heading (rad, -2π to 2π) or
    /// altitude (m, -500 to 20,000), in the next tick; ends a pattern.
    #[pyo3(signature = (*, airspeed_mps = None, heading_rad = None, altitude_m = None))]
    fn order(
        &self,
        airspeed_mps: Option<f64>,
        heading_rad: Option<f64>,
        altitude_m: Option<f64>,
    ) -> PyResult<()> {
        for order in checked_orders(airspeed_mps, heading_rad, altitude_m)? {
            self.send(Order::Controller(order))?;
        }
        Ok(())
    }

    /// `"standby"`, `"engaged"`, `"failsafe"` or `"stopped"`.
    #[getter]
    fn state(&self) -> &'static str {
        state_name(self.inner().machine.state())
    }

    /// The loop's time in s: periods that have passed.
    #[getter]
    fn time_s(&self) -> f64 {
        let inner = self.inner();
        inner.number as f64 * inner.period_ns as f64 * 1e-9
    }

    /// Time between ticks in s.
    #[getter]
    fn period_s(&self) -> f64 {
        self.inner().period_ns as f64 * 1e-9
    }

    /// Why the loop may not engage, in words, as of the last tick.
    #[getter]
    fn blockers(&self) -> Vec<&'static str> {
        names(self.inner().machine.record().blockers)
    }

    /// What makes going on unsafe, in words, as of the last tick.
    #[getter]
    fn faults(&self) -> Vec<&'static str> {
        names(self.inner().machine.record().faults)
    }

    /// The present set points.
    #[getter]
    fn setpoints(&self) -> PySetpoints {
        self.inner().machine.controller().setpoints().into()
    }

    /// What navigation makes of the measurements.
    #[getter]
    fn estimate(&self) -> PyEstimate {
        self.inner().machine.controller().estimated().into()
    }

    /// The records of all ticks since this was last called, as a structured
    /// array (`fcc.RECORD`).
    fn records<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<RecordRow>> {
        let rows = std::mem::take(&mut self.inner().rows);
        structured::records(py, rows)
    }

    /// What happened since this was last called.
    fn events(&self) -> Vec<PyEvent> {
        std::mem::take(&mut self.inner().events)
    }
}

impl Inner {
    fn step(
        &mut self,
        measurements: Option<&PyMeasurements>,
        switch: Option<bool>,
        missed: u64,
    ) -> Option<Surfaces> {
        self.number += 1 + missed;
        let at_ns = self.number as i64 * self.period_ns;
        if let Some(measurements) = measurements {
            let told = Measured {
                now: Time::from_nanos(at_ns),
                plant_s: at_ns as f64 * 1e-9,
                standing: self.standing,
                switch: switch.map(|on| if on { Switch::On } else { Switch::Off }),
            };
            // The sensor has emptied the ring in the tick before.
            let _ = self.measured.push(measurements.to_core(&told));
        }
        self.machine.tick(Expiry {
            number: self.number,
            scheduled_ns: at_ns,
            woke_ns: at_ns,
            missed,
        });
        let caller = [CALLER.to_owned()];
        while let Some(message) = self.link.messages.receive() {
            match message {
                Message::Tick(record) => self.rows.push(RecordRow::from(&record)),
                Message::Event(event) => self.events.push(PyEvent::of(&event, &caller, &caller)),
            }
        }
        let record = self.machine.record();
        let sent = record.sent.then_some(record.outputs)?;
        self.standing = Some(sent);
        self.standing
    }
}

/// What a state is called.
pub(crate) const fn state_name(state: State) -> &'static str {
    match state {
        State::Standby => "standby",
        State::Engaged => "engaged",
        State::Failsafe(_) => "failsafe",
        State::Stopped => "stopped",
    }
}

/// A timer that is there for its period: the caller is the clock.
struct CalledTimes {
    period: Duration,
}

impl Timer for CalledTimes {
    fn start(&mut self) -> Result<(), TimerError> {
        Ok(())
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        Err(TimerError::Ended)
    }

    fn period(&self) -> Duration {
        self.period
    }

    /// Only stages are timed with it, and in lockstep they take no time.
    fn now_ns(&self) -> i64 {
        0
    }

    fn name(&self) -> &'static str {
        "lockstep"
    }
}

/// Hands out what the caller has measured, once.
struct Handed {
    handed: Consumer<Measurements>,
}

impl Sensor<Measurements> for Handed {
    fn sample(&mut self, _: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        *into = self.handed.pop().map_err(|_| SensorFault::Silent)?;
        Ok(())
    }

    fn name(&self) -> &'static str {
        CALLER
    }
}

/// The caller takes what is sent from the tick's record.
struct Nothing;

impl Actuator<Surfaces> for Nothing {
    fn apply(&mut self, _: &Tick, _: &Surfaces) -> Result<(), ActuatorFault> {
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        Ok(())
    }

    fn name(&self) -> &'static str {
        CALLER
    }
}
