//! Many autopilots stepped together, for searches over gains and scenarios.

use fcc_core::flight::Surfaces;
use fcc_core::framework::Controller;
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arguments::{rows, step_s};
use crate::autopilot::{matrix, series, surface_row};
use crate::config::autopilot_config;
use crate::errors;
use crate::stepped::Stepped;
use crate::values::{COLUMNS, PyMeasurements, checked_surfaces};

/// Many autopilots, each with its own configuration, stepped together: row i
/// of an array belongs to autopilot i.
///
/// `configs` is a sequence of `Config` or of texts as for `Autopilot`.
#[pyclass(name = "Fleet", module = "fcc")]
pub(crate) struct PyFleet {
    autopilots: Vec<Stepped>,
}

#[pymethods]
impl PyFleet {
    #[new]
    fn new(configs: &Bound<'_, PyAny>) -> PyResult<Self> {
        let autopilots = configs
            .try_iter()?
            .map(|config| Ok(Stepped::new(&autopilot_config(Some(&config?))?)))
            .collect::<PyResult<Vec<_>>>()?;
        if autopilots.is_empty() {
            return Err(PyValueError::new_err(
                "configs is empty: give one configuration for each autopilot",
            ));
        }
        Ok(Self { autopilots })
    }

    fn __len__(&self) -> usize {
        self.autopilots.len()
    }

    /// Takes measurements, an array of shape (n, 11) with the columns
    /// `fcc.MEASUREMENTS`, `dt` s after the last, without controlling.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn observe(
        &mut self,
        py: Python<'_>,
        measurements: &Bound<'_, PyAny>,
        dt: f64,
    ) -> PyResult<()> {
        let (each, dt_s) = (self.each(measurements)?, step_s(dt)?);
        py.detach(|| {
            for (autopilot, row) in self.autopilots.iter_mut().zip(&each) {
                autopilot.observe(PyMeasurements::from_row(row), dt_s);
            }
        });
        Ok(())
    }

    /// Takes over: all, or none. `surfaces`, of shape (n, 4) with the columns
    /// `fcc.SURFACES`, is where the controls stand.
    ///
    /// Raises `EngageError` if something blocks one of them, with what.
    #[pyo3(signature = (measurements, surfaces, dt = 0.025))]
    fn engage(
        &mut self,
        measurements: &Bound<'_, PyAny>,
        surfaces: &Bound<'_, PyAny>,
        dt: f64,
    ) -> PyResult<()> {
        let (each, dt_s) = (self.each(measurements)?, step_s(dt)?);
        let standing = rows::<4>("surfaces", "fcc.SURFACES", surfaces)?;
        self.must_be_as_many("surfaces", standing.len())?;
        let mut engaged = self.autopilots.clone();
        for (n, ((autopilot, row), standing)) in
            engaged.iter_mut().zip(&each).zip(&standing).enumerate()
        {
            let &[throttle, elevator, aileron, rudder] = standing;
            let standing = checked_surfaces(Surfaces {
                throttle,
                elevator,
                aileron,
                rudder,
            })?;
            autopilot
                .engage(PyMeasurements::from_row(row), dt_s, standing)
                .map_err(|words| errors::ENGAGE.say(format_args!("autopilot {n}: {words}")))?;
        }
        self.autopilots = engaged;
        Ok(())
    }

    /// One tick of all, `dt` s after the last: from measurements of shape
    /// (n, 11) to surfaces of shape (n, 4).
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        measurements: &Bound<'py, PyAny>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (each, dt_s) = (self.each(measurements)?, step_s(dt)?);
        for autopilot in &self.autopilots {
            autopilot.must_be_engaged()?;
        }
        let surfaces: Vec<[f64; 4]> = py.detach(|| {
            self.autopilots
                .iter_mut()
                .zip(&each)
                .map(|(autopilot, row)| {
                    surface_row(autopilot.step(PyMeasurements::from_row(row), dt_s))
                })
                .collect()
        });
        matrix(py, surfaces)
    }

    /// The set points of each, of shape (n, 6): airspeed in m/s, heading in
    /// rad, altitude in m, roll in rad, climb rate in m/s, pitch in rad.
    #[getter]
    fn setpoints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let each = self.autopilots.iter().map(|autopilot| {
            let setpoints = autopilot.autopilot.setpoints();
            [
                setpoints.airspeed_mps,
                setpoints.heading_rad,
                setpoints.altitude_m,
                setpoints.roll_rad,
                setpoints.climb_rate_mps,
                setpoints.pitch_rad,
            ]
        });
        matrix(py, each.collect())
    }
}

impl PyFleet {
    fn each(&self, measurements: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; COLUMNS.len()]>> {
        let each = series(measurements)?;
        self.must_be_as_many("measurements", each.len())?;
        Ok(each)
    }

    fn must_be_as_many(&self, name: &str, rows: usize) -> PyResult<()> {
        if rows == self.autopilots.len() {
            return Ok(());
        }
        Err(PyValueError::new_err(format!(
            "{name} has {rows} rows: give one for each of the {} autopilots",
            self.autopilots.len()
        )))
    }
}
