//! The calibration of a sensor of three axes, from arrays.

use fcc_core::flight::calibration::fit_strength;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{finite, numbers, shape_words};

/// Bias, scale and misalignment by which all samples have one `strength`:
/// gravity's in m/s² of an accelerometer at rest, the field's in µT of a
/// magnetometer. `samples` is (n, 3), in the sensor's axes, of many directions.
///
/// Returns a dict with `bias`, `scale` and `misalignment` as in the
/// configuration's `calibration`, `residual` (RMS of what is left), `bias_sigma`,
/// and `spread` (the least share of the directions along any axis: a third is the
/// best). Raises `ValueError` with the reason if there is no calibration.
#[pyfunction]
pub(crate) fn calibrate<'py>(
    py: Python<'py>,
    samples: &Bound<'py, PyAny>,
    strength: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let strength = finite("strength", strength)?;
    if strength <= 0.0 {
        return Err(PyValueError::new_err(format!(
            "strength is {strength}: give that of gravity in m/s², or of the field in µT"
        )));
    }
    let (shape, values) = numbers("samples", samples)?;
    let rows: Vec<[f64; 3]> = match shape.as_slice() {
        [_, 3] => values.as_chunks::<3>().0.to_vec(),
        _ => {
            return Err(PyValueError::new_err(format!(
                "samples is of shape {}: give (n, 3)",
                shape_words(&shape)
            )));
        }
    };
    let fit = py
        .detach(|| fit_strength(&rows, strength))
        .map_err(|error| PyValueError::new_err(format!("samples: {error}")))?;
    let found = PyDict::new(py);
    found.set_item("bias", fit.axes.bias)?;
    found.set_item("scale", fit.axes.scale)?;
    found.set_item("misalignment", fit.axes.misalignment)?;
    found.set_item("residual", fit.residual)?;
    found.set_item("bias_sigma", fit.bias_sigma)?;
    found.set_item("spread", fit.spread)?;
    Ok(found)
}
