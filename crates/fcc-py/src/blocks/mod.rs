//! The core's control blocks, one step per call or a series at once.

mod filters;
mod pid;

pub(crate) use filters::{
    PyComplementary, PyHighPass, PyLowPass, PyRateLimit, PySquareRootProfile,
};
pub(crate) use pid::PyPid;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A time since the last step, s: 0 or more.
fn passed_s(dt: f64) -> PyResult<f64> {
    not_negative("dt", dt)
}

/// A time in s: 0 or more.
fn not_negative(name: &str, seconds: f64) -> PyResult<f64> {
    if seconds >= 0.0 && seconds.is_finite() {
        return Ok(seconds);
    }
    Err(PyValueError::new_err(format!(
        "{name} is {seconds} s: it must be 0 or more"
    )))
}

/// A number above 0.
fn positive(name: &str, value: f64) -> PyResult<f64> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(PyValueError::new_err(format!(
        "{name} is {value}: it must be above 0"
    )))
}
