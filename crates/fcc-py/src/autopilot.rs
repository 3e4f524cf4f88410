//! The autopilot, one call per tick.

use std::sync::{Mutex, MutexGuard, PoisonError};

use fcc_core::flight::Surfaces;
use fcc_core::framework::Controller;
use fcc_fixed_wing::Autopilot;
use numpy::{PyArray2, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;

use crate::arguments::{Rows, rows, step_s};
use crate::commanded::{Given, commands};
use crate::config::autopilot_config;
use crate::errors;
use crate::machine::conditions;
use crate::stepped::Stepped;
use crate::values::{
    PyEstimate, PyMeasurements, PySetpoints, PySurfaces, Values, as_row, checked, from_row, names,
};

/// The autopilot, one call per tick: `observe` while the pilot flies,
/// `engage` once, then `step` in each tick; `observe_series` and `fly` do the
/// same for a recorded series of measurements.
///
/// `config` is a `Config`, or the text of a configuration file as `fccd` reads
/// it; only `[guidance]`, `[autopilot]` and `[failsafe]` are used.
///
/// >>> aircraft, autopilot = fcc.BuiltInAircraft(), fcc.Autopilot()
/// >>> for _ in range(100):
/// ...     measured = aircraft.step(None)
/// ...     autopilot.observe(measured)
/// >>> autopilot.engage(measured, throttle=aircraft.controls.throttle)
/// >>> for _ in range(400):
/// ...     measured = aircraft.step(autopilot.step(measured))
/// >>> abs(aircraft.truth.altitude_m - autopilot.setpoints.altitude_m) < 10.0
/// True
#[pyclass(name = "Autopilot", module = "fcc", frozen)]
pub(crate) struct PyAutopilot {
    stepped: Mutex<Stepped>,
}

impl PyAutopilot {
    /// One thread after the other.
    fn stepped(&self, py: Python<'_>) -> MutexGuard<'_, Stepped> {
        let stepped = self.stepped.lock_py_attached(py);
        stepped.unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PyAutopilot {
    #[new]
    #[pyo3(signature = (config = None))]
    fn new(config: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self {
            stepped: Mutex::new(Stepped::new(&autopilot_config(config)?)),
        })
    }

    /// Processes measurements `dt` seconds after the previous ones without
    /// controlling, so that the filters settle.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn observe(&self, py: Python<'_>, measurements: &PyMeasurements, dt: f64) -> PyResult<()> {
        self.stepped(py).observe(measurements, step_s(dt)?);
        Ok(())
    }

    /// Processes a series of measurements without controlling: an array of shape
    /// (n, m), the columns being `fcc.MEASUREMENTS`, the rows `dt` s apart.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn observe_series(
        &self,
        py: Python<'_>,
        measurements: &Bound<'_, PyAny>,
        dt: f64,
    ) -> PyResult<()> {
        let (series, dt_s) = (series(measurements)?, step_s(dt)?);
        let mut stepped = self.stepped(py);
        let stepped = &mut *stepped;
        series.in_pieces(py, |row| stepped.observe(&from_row(row), dt_s))
    }

    /// Engages, `dt` seconds after the previous measurements: the present state
    /// becomes the set points. `throttle`, `elevator`, `aileron`, `rudder`
    /// and `elevator_trim` are the present positions of the controls; without a
    /// trim, none is moved.
    ///
    /// Raises `EngageError` with the engage inhibits, if there are any.
    #[pyo3(signature = (measurements, dt = 0.025, *, throttle,
                        elevator = 0.0, aileron = 0.0, rudder = 0.0, elevator_trim = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn engage(
        this: &Bound<'_, Self>,
        measurements: &PyMeasurements,
        dt: f64,
        throttle: f64,
        elevator: f64,
        aileron: f64,
        rudder: f64,
        elevator_trim: Option<f64>,
    ) -> PyResult<()> {
        let readback = checked(Surfaces {
            throttle,
            elevator,
            aileron,
            rudder,
            elevator_trim,
            ..Surfaces::IDLE
        })?;
        this.get()
            .stepped(this.py())
            .engage(measurements, step_s(dt)?, readback)
            .map_err(|words| errors::ENGAGE.with(words))
    }

    /// One tick, `dt` seconds after the previous one; returns the surfaces.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn step(&self, py: Python<'_>, measurements: &PyMeasurements, dt: f64) -> PyResult<PySurfaces> {
        let mut stepped = self.stepped(py);
        stepped.must_be_engaged()?;
        Ok(stepped.step(measurements, step_s(dt)?).into())
    }

    /// One tick for each row of a series, as by `step`. `measurements` is an array of
    /// shape (n, m), the columns being `fcc.MEASUREMENTS`, the rows `dt` s apart; the
    /// result is of shape (n, s), the columns being `fcc.SURFACES`.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn fly<'py>(
        &self,
        py: Python<'py>,
        measurements: &Bound<'py, PyAny>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (series, dt_s) = (series(measurements)?, step_s(dt)?);
        let mut stepped = self.stepped(py);
        let stepped = &mut *stepped;
        stepped.must_be_engaged()?;
        let mut flown = Vec::new();
        series.in_pieces(py, |row| {
            let surfaces = stepped.step(&from_row(row), dt_s);
            as_row::<PySurfaces>(surfaces.into(), &mut flown);
        })?;
        matrix::<PySurfaces>(py, &flown)
    }

    /// One tick of failsafe, `dt` seconds after the previous one; returns the
    /// safest surfaces that the remaining measurements allow.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn failsafe(
        &self,
        py: Python<'_>,
        measurements: &PyMeasurements,
        dt: f64,
    ) -> PyResult<PySurfaces> {
        let mut stepped = self.stepped(py);
        stepped.must_be_engaged()?;
        Ok(stepped.failsafe(measurements, step_s(dt)?).into())
    }

    /// Disengages.
    fn disengage(&self, py: Python<'_>) {
        self.stepped(py).disengage();
    }

    /// Commands another airspeed (m/s), heading (rad) or altitude (m): above sea
    /// level by the altimeter setting, or a pressure altitude, or a height above
    /// the configured field; ends a pattern or a plan. An altimeter setting (Pa) and a
    /// heartbeat (s) end none,
    /// and are also accepted without being engaged. Of a plan: `plan_item` (0: where it was left), `pause` and
    /// `return_home` (1), and the three of `go_to_latitude_rad`.
    #[pyo3(signature = (**setpoints))]
    fn command(&self, py: Python<'_>, setpoints: Option<Given>) -> PyResult<()> {
        let mut stepped = self.stepped(py);
        let commands = commands(setpoints, stepped.autopilot.config())?;
        if commands
            .iter()
            .any(fcc_fixed_wing::AutopilotCommand::is_of_mode)
        {
            stepped.must_be_engaged()?;
        }
        stepped.command(commands);
        Ok(())
    }

    /// Whether it is engaged.
    #[getter]
    fn engaged(&self, py: Python<'_>) -> bool {
        self.stepped(py).is_engaged()
    }

    /// The present set points.
    #[getter]
    fn setpoints(&self, py: Python<'_>) -> PySetpoints {
        self.stepped(py).autopilot.setpoints().into()
    }

    /// Navigation's estimate.
    #[getter]
    fn estimate(&self, py: Python<'_>) -> PyEstimate {
        self.stepped(py).autopilot.estimated().into()
    }

    /// The engage inhibits, as text; empty if it may engage.
    #[getter]
    fn engage_inhibits(&self, py: Python<'_>) -> Vec<&'static str> {
        conditions::<Autopilot>(self.stepped(py).engage_inhibits())
    }

    /// The faults that make it unsafe to stay engaged, as text.
    #[getter]
    fn faults(&self, py: Python<'_>) -> Vec<&'static str> {
        conditions::<Autopilot>(self.stepped(py).faults())
    }
}

/// A series of measurements.
pub(crate) fn series(measurements: &Bound<'_, PyAny>) -> PyResult<Rows> {
    rows::<PyMeasurements>("measurements", "fcc.MEASUREMENTS", measurements)
}

/// The numbers of objects, row by row.
pub(crate) fn table<V: Values>(rows: impl Iterator<Item = V>) -> Vec<f64> {
    let mut numbers = Vec::new();
    rows.for_each(|row| as_row(row, &mut numbers));
    numbers
}

/// Rows as an array.
pub(crate) fn matrix<'py, V: Values>(
    py: Python<'py>,
    numbers: &[f64],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let width = names::<V>().count();
    let rows = numbers.len() / width.max(1);
    numbers.to_pyarray(py).reshape([rows, width])
}
