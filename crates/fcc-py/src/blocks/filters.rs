//! Filters, limiters, profiles.

use fcc_core::blocks::{Complementary, HighPass, LowPass, RateLimit, SquareRootProfile};
use numpy::{PyArray1, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::{passed_s, positive, tau_s};
use crate::arguments::{finite, numbers, shape_words};

/// A series of inputs, each finite.
fn inputs(from: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let (shape, values) = numbers("inputs", from)?;
    if shape.len() != 1 {
        return Err(PyValueError::new_err(format!(
            "inputs is of shape {}: give (n,)",
            shape_words(&shape)
        )));
    }
    for (at, value) in values.iter().enumerate() {
        finite(&format!("inputs[{at}]"), *value)?;
    }
    Ok(values)
}

/// Runs a block over a series; the outputs.
fn run<'py>(
    py: Python<'py>,
    from: &Bound<'py, PyAny>,
    dt: f64,
    mut step: impl FnMut(f64, f64) -> f64 + Send,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (inputs, dt_s) = (inputs(from)?, passed_s(dt)?);
    let outputs: Vec<f64> = py.detach(|| inputs.iter().map(|input| step(*input, dt_s)).collect());
    Ok(outputs.to_pyarray(py))
}

/// First-order low pass of a time constant in s (0 for none): it begins at its
/// first input.
#[pyclass(name = "LowPass", module = "fcc")]
pub(crate) struct PyLowPass(LowPass);

#[pymethods]
impl PyLowPass {
    #[new]
    fn new(tau_s: f64) -> PyResult<Self> {
        Ok(Self(LowPass::new(self::tau_s(tau_s)?)))
    }

    /// Takes an input held for `dt` s; the output.
    fn step(&mut self, value: f64, dt: f64) -> PyResult<f64> {
        Ok(self.0.step(finite("value", value)?, passed_s(dt)?))
    }

    /// Takes a series of inputs, each held for `dt` s; the outputs.
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        inputs: &Bound<'py, PyAny>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        run(py, inputs, dt, |input, dt_s| self.0.step(input, dt_s))
    }

    /// Sets the output.
    fn reset(&mut self, output: f64) -> PyResult<()> {
        self.0.reset(finite("output", output)?);
        Ok(())
    }

    /// The output, 0 before any input.
    #[getter]
    fn output(&self) -> f64 {
        self.0.output()
    }
}

/// First-order high pass of a time constant in s: the input less its
/// low-passed self.
#[pyclass(name = "HighPass", module = "fcc")]
pub(crate) struct PyHighPass(HighPass);

#[pymethods]
impl PyHighPass {
    #[new]
    fn new(tau_s: f64) -> PyResult<Self> {
        Ok(Self(HighPass::new(self::tau_s(tau_s)?)))
    }

    /// Takes an input held for `dt` s; the output.
    fn step(&mut self, value: f64, dt: f64) -> PyResult<f64> {
        Ok(self.0.step(finite("value", value)?, passed_s(dt)?))
    }

    /// Takes a series of inputs, each held for `dt` s; the outputs.
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        inputs: &Bound<'py, PyAny>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        run(py, inputs, dt, |input, dt_s| self.0.step(input, dt_s))
    }

    /// Sets what is taken for the constant part of the input.
    fn reset(&mut self, constant: f64) -> PyResult<()> {
        self.0.reset(finite("constant", constant)?);
        Ok(())
    }
}

/// Limits how fast a signal may move, in units per second: it begins at its
/// first input.
#[pyclass(name = "RateLimit", module = "fcc")]
pub(crate) struct PyRateLimit(RateLimit);

#[pymethods]
impl PyRateLimit {
    #[new]
    fn new(rate_per_s: f64) -> PyResult<Self> {
        Ok(Self(RateLimit::new(positive("rate_per_s", rate_per_s)?)))
    }

    /// Moves towards an input for `dt` s; the output.
    fn step(&mut self, value: f64, dt: f64) -> PyResult<f64> {
        Ok(self.0.step(finite("value", value)?, passed_s(dt)?))
    }

    /// Moves towards a series of inputs, each for `dt` s; the outputs.
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        inputs: &Bound<'py, PyAny>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        run(py, inputs, dt, |input, dt_s| self.0.step(input, dt_s))
    }

    /// Sets the output.
    fn reset(&mut self, output: f64) -> PyResult<()> {
        self.0.reset(finite("output", output)?);
        Ok(())
    }
}

/// First-order complementary filter: integrates a rate, and leans towards a
/// measurement with a time constant in s.
#[pyclass(name = "Complementary", module = "fcc")]
pub(crate) struct PyComplementary(Complementary);

#[pymethods]
impl PyComplementary {
    #[new]
    fn new(tau_s: f64) -> PyResult<Self> {
        Ok(Self(Complementary::new(self::tau_s(tau_s)?)))
    }

    /// Integrates a rate (units per second) for `dt` s.
    fn predict(&mut self, rate: f64, dt: f64) -> PyResult<()> {
        self.0.predict(finite("rate", rate)?, passed_s(dt)?);
        Ok(())
    }

    /// Leans towards a measurement that comes `dt` s after the one before.
    fn correct(&mut self, measurement: f64, dt: f64) -> PyResult<()> {
        self.0
            .correct(finite("measurement", measurement)?, passed_s(dt)?);
        Ok(())
    }

    /// Sets the value.
    fn reset(&mut self, value: f64) -> PyResult<()> {
        self.0.reset(finite("value", value)?);
        Ok(())
    }

    /// The value.
    #[getter]
    fn value(&self) -> f64 {
        self.0.value()
    }
}

/// How fast to close an error so that braking at a constant deceleration ends
/// at nought: proportional near the target (`gain_per_s`, 1/s), a square root
/// further out (`deceleration`, units/s²).
#[pyclass(name = "SquareRootProfile", module = "fcc", frozen)]
pub(crate) struct PySquareRootProfile(SquareRootProfile);

#[pymethods]
impl PySquareRootProfile {
    #[new]
    fn new(gain_per_s: f64, deceleration: f64) -> PyResult<Self> {
        Ok(Self(SquareRootProfile {
            gain_per_s: positive("gain_per_s", gain_per_s)?,
            deceleration: positive("deceleration", deceleration)?,
        }))
    }

    /// The closing speed for an error, units/s, of the error's sign.
    fn speed(&self, error: f64) -> PyResult<f64> {
        Ok(self.0.speed(finite("error", error)?))
    }
}
