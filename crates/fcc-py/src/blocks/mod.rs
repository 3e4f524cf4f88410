//! Control blocks: the core's own, one step a call or a series at once.

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
    if dt >= 0.0 && dt.is_finite() {
        return Ok(dt);
    }
    Err(PyValueError::new_err(format!(
        "dt is {dt} s: it must be 0 or more"
    )))
}

/// A time constant, s: 0 or more.
fn tau_s(tau: f64) -> PyResult<f64> {
    if tau >= 0.0 && tau.is_finite() {
        return Ok(tau);
    }
    Err(PyValueError::new_err(format!(
        "tau_s is {tau} s: it must be 0 or more"
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
