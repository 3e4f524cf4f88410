//! The autopilot, stepped by hand.

use std::time::Duration;

use fcc_core::flight::{Autopilot, Measurements, Order, Surfaces};
use fcc_core::framework::{Controller, Tick, Time};
use fcc_daemon::config::Config;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::values::{PyMeasurements, PySetpoints, PySurfaces};

/// The longest step, s: past it, nothing is a control loop any more.
const MAX_STEP_S: f64 = 1.0;

/// The autopilot, stepped by hand: `observe` while somebody else flies,
/// `engage` once, then `step` for each tick.
///
/// `config` is the text of a configuration file as `fccd` reads it; its
/// sections `[course]` and `[autopilot]` matter here.
#[pyclass(name = "Autopilot")]
pub(crate) struct PyAutopilot {
    autopilot: Autopilot,
    tick: Tick,
    time_s: f64,
    engaged: bool,
}

#[pymethods]
impl PyAutopilot {
    #[new]
    #[pyo3(signature = (config = ""))]
    fn new(config: &str) -> PyResult<Self> {
        let config = Config::parse_autopilot(config, "config")
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self {
            autopilot: Autopilot::new(config),
            tick: Tick::default(),
            time_s: 0.0,
            engaged: false,
        })
    }

    /// Takes measurements `dt` seconds after the last without controlling, so
    /// that the filters settle.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn observe(&mut self, measurements: &PyMeasurements, dt: f64) -> PyResult<()> {
        self.take(measurements, dt, Surfaces::default()).map(|_| ())
    }

    /// Takes over, `dt` seconds after the last measurements: the present
    /// becomes the set points. `throttle`, `elevator`, `aileron` and `rudder`
    /// are where the controls stand.
    ///
    /// Raises `RuntimeError` if something blocks it, with what.
    #[pyo3(signature = (measurements, dt = 0.025, *, throttle,
                        elevator = 0.0, aileron = 0.0, rudder = 0.0))]
    fn engage(
        &mut self,
        measurements: &PyMeasurements,
        dt: f64,
        throttle: f64,
        elevator: f64,
        aileron: f64,
        rudder: f64,
    ) -> PyResult<()> {
        let standing = Surfaces {
            throttle,
            elevator,
            aileron,
            rudder,
        };
        if !standing.is_valid() {
            return Err(PyValueError::new_err(format!(
                "the controls stand at {standing:?}: throttle is 0 to 1, the others -1 to 1"
            )));
        }
        let taken = self.take(measurements, dt, standing)?;
        let blockers = self.autopilot.blockers(&self.tick, &taken);
        if !blockers.is_empty() {
            let names: Vec<_> = blockers.iter().map(Autopilot::flag_name).collect();
            return Err(PyRuntimeError::new_err(format!(
                "not engaged: {}",
                names.join(", ")
            )));
        }
        self.autopilot.engage(&self.tick, &taken);
        self.engaged = true;
        Ok(())
    }

    /// One tick, `dt` seconds after the last: the surfaces to set.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn step(&mut self, measurements: &PyMeasurements, dt: f64) -> PyResult<PySurfaces> {
        self.must_be_engaged()?;
        let taken = self.take(measurements, dt, Surfaces::default())?;
        self.autopilot.guide(&self.tick, &taken);
        Ok(self.autopilot.control(&self.tick, &taken).into())
    }

    /// Orders another airspeed (m/s), heading (rad) or altitude (m); ends a
    /// pattern.
    #[pyo3(signature = (*, airspeed_mps = None, heading_rad = None, altitude_m = None))]
    fn order(
        &mut self,
        airspeed_mps: Option<f64>,
        heading_rad: Option<f64>,
        altitude_m: Option<f64>,
    ) -> PyResult<()> {
        self.must_be_engaged()?;
        let orders = [
            airspeed_mps.map(Order::Airspeed),
            heading_rad.map(Order::Heading),
            altitude_m.map(Order::Altitude),
        ];
        for order in orders.into_iter().flatten() {
            self.autopilot.command(&order);
        }
        Ok(())
    }

    /// The present set points.
    #[getter]
    fn setpoints(&self) -> PySetpoints {
        self.autopilot.setpoints().into()
    }
}

impl PyAutopilot {
    fn must_be_engaged(&self) -> PyResult<()> {
        if self.engaged {
            return Ok(());
        }
        Err(PyRuntimeError::new_err(
            "the autopilot is not engaged: call engage() first",
        ))
    }

    fn take(
        &mut self,
        measurements: &PyMeasurements,
        dt_s: f64,
        standing: Surfaces,
    ) -> PyResult<Measurements> {
        if !(dt_s > 0.0 && dt_s <= MAX_STEP_S) {
            return Err(PyValueError::new_err(format!(
                "dt is {dt_s} s: it must be above 0 and at most {MAX_STEP_S}"
            )));
        }
        self.time_s += dt_s;
        let now = Time::from_nanos(Duration::from_secs_f64(self.time_s).as_nanos() as i64);
        self.tick = Tick {
            number: self.tick.number + 1,
            scheduled: now,
            woke: now,
            missed: 0,
            dt_s,
        };
        let taken = measurements.to_core(now, self.time_s, standing);
        self.autopilot.estimate(&self.tick, &taken);
        Ok(taken)
    }
}
