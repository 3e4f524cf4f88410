//! Many autopilots in one call, for searches over gains and scenarios.

use fcc_core::framework::Controller;
use numpy::{PyArray2, PyArrayMethods, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arguments::{Rows, rows, step_s};
use crate::autopilot::{matrix, series, table};
use crate::config::autopilot_config;
use crate::errors;
use crate::stepped::Stepped;
use crate::values::{PySetpoints, PySurfaces, Values as _, as_row, checked, from_row};

/// Many autopilots, each with its own configuration, in one call per tick: row i
/// of an array belongs to autopilot i.
///
/// `configs` is a sequence of `Config` or of texts as for `Autopilot`.
///
/// >>> fleet = fcc.Fleet(["", "[autopilot.heading]\nroll_gain_per_s = 2.0"])
/// >>> aircraft = fcc.BuiltInAircraft()
/// >>> for _ in range(100):
/// ...     measured = [aircraft.step(None).to_array()] * 2
/// ...     fleet.observe(measured)
/// >>> fleet.engage(measured, [aircraft.controls.to_array()] * 2)
/// >>> fleet.step(measured).shape == (2, len(fcc.SURFACES))
/// True
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

    /// Processes measurements, an array of shape (n, m) with the columns
    /// `fcc.MEASUREMENTS`, `dt` s after the previous ones, without controlling.
    #[pyo3(signature = (measurements, dt = 0.025))]
    fn observe(
        &mut self,
        py: Python<'_>,
        measurements: &Bound<'_, PyAny>,
        dt: f64,
    ) -> PyResult<()> {
        let (each, dt_s) = (self.each(measurements)?, step_s(dt)?);
        py.detach(|| {
            for (autopilot, row) in self.autopilots.iter_mut().zip(each.iter()) {
                autopilot.observe(&from_row(row), dt_s);
            }
        });
        Ok(())
    }

    /// Engages all, or none. `surfaces`, of shape (n, s) with the columns
    /// `fcc.SURFACES`, contains the present positions of the controls.
    ///
    /// Raises `EngageError` with the engage inhibits of the first that has any.
    #[pyo3(signature = (measurements, surfaces, dt = 0.025))]
    fn engage(
        &mut self,
        measurements: &Bound<'_, PyAny>,
        surfaces: &Bound<'_, PyAny>,
        dt: f64,
    ) -> PyResult<()> {
        let (each, dt_s) = (self.each(measurements)?, step_s(dt)?);
        let readbacks = rows::<PySurfaces>("surfaces", "fcc.SURFACES", surfaces)?;
        self.must_be_as_many("surfaces", readbacks.iter().len())?;
        let mut engaged = self.autopilots.clone();
        let rows = each.iter().zip(readbacks.iter());
        for (n, (autopilot, (row, readback))) in engaged.iter_mut().zip(rows).enumerate() {
            let readback = checked(from_row::<PySurfaces>(readback).into())?;
            autopilot
                .engage(&from_row(row), dt_s, readback)
                .map_err(|words| errors::ENGAGE.with(format_args!("autopilot {n}: {words}")))?;
        }
        self.autopilots = engaged;
        Ok(())
    }

    /// One tick of all, `dt` s after the previous one: measurements of shape
    /// (n, m); returns surfaces of shape (n, s).
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
        let surfaces = py.detach(|| {
            let rows = self.autopilots.iter_mut().zip(each.iter());
            let steps = rows.map(|(autopilot, row)| autopilot.step(&from_row(row), dt_s));
            table::<PySurfaces>(steps.map(Into::into))
        });
        matrix::<PySurfaces>(py, &surfaces)
    }

    /// The set points of each, of shape (n, 6): airspeed in m/s, heading in
    /// rad, altitude in m, roll in rad, climb rate in m/s, pitch in rad.
    #[getter]
    fn setpoints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        // Guidance's mode and progress are nested, and come after these, before
        // the altimeter.
        let leaves = PySetpoints::attributes().leaves.iter();
        let own = leaves.take_while(|(_, leaf)| !leaf.column.path.contains('.'));
        let width = own.count();
        let mut numbers = Vec::new();
        for (n, autopilot) in self.autopilots.iter().enumerate() {
            as_row::<PySetpoints>(autopilot.autopilot.setpoints().into(), &mut numbers);
            numbers.truncate((n + 1) * width);
        }
        numbers
            .to_pyarray(py)
            .reshape([self.autopilots.len(), width])
    }
}

impl PyFleet {
    fn each(&self, measurements: &Bound<'_, PyAny>) -> PyResult<Rows> {
        let each = series(measurements)?;
        self.must_be_as_many("measurements", each.iter().len())?;
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
