//! The calibration of a sensor of three axes, from arrays.

use fcc_core::flight::calibration::{self, AxesCalibration, Rotation, fit_strength};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{finite, numbers, shape_words, vector};

/// Bias, scale and misalignment by which all samples have one `strength`:
/// gravity's in m/s² of an accelerometer at rest, the field's in µT of a
/// magnetometer. `samples` is (n, 3), in the sensor's axes, of many directions.
///
/// Returns a dict with `bias`, `scale` and `misalignment` as in the
/// configuration's `calibration`, `matrix` (3 rows: scale and misalignment, of what
/// is given less the bias), `residual` (RMS of what is left), `bias_sigma`,
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
    let rows = axes("samples", samples)?;
    let fit = py
        .detach(|| fit_strength(&rows, strength))
        .map_err(|error| PyValueError::new_err(format!("samples: {error}")))?;
    let found = PyDict::new(py);
    found.set_item("bias", fit.axes.bias)?;
    found.set_item("scale", fit.axes.scale)?;
    found.set_item("misalignment", fit.axes.misalignment)?;
    found.set_item("matrix", AxesCalibration::new(&fit.axes).matrix())?;
    found.set_item("residual", fit.residual)?;
    found.set_item("bias_sigma", fit.bias_sigma)?;
    found.set_item("spread", fit.spread)?;
    Ok(found)
}

/// The smallest rotation, as a matrix of three rows, after which the specific
/// force of a level aircraft at rest points up. Raises `ValueError` if it points
/// down.
#[pyfunction]
pub(crate) fn levelled(force_mps2: &Bound<'_, PyAny>) -> PyResult<[[f64; 3]; 3]> {
    let force = vector("force_mps2", force_mps2)?;
    let Some(Rotation(rows)) = calibration::levelled(force) else {
        return Err(PyValueError::new_err(
            "force_mps2 does not point up: the sensor is mounted in another way",
        ));
    };
    Ok(rows)
}

/// The rotation of a magnetometer, as a matrix of three rows, after which the
/// field has the same dip in all attitudes: `down` and `field` are (n, 3), of the
/// same instants. Raises `ValueError` if they do not determine it.
#[pyfunction]
pub(crate) fn constant_dip(
    down: &Bound<'_, PyAny>,
    field: &Bound<'_, PyAny>,
) -> PyResult<[[f64; 3]; 3]> {
    let (down, field) = (axes("down", down)?, axes("field", field)?);
    if down.len() != field.len() {
        return Err(PyValueError::new_err(format!(
            "down has {} rows, and field has {}: give as many",
            down.len(),
            field.len()
        )));
    }
    let fit = calibration::constant_dip(down.into_iter().zip(field)).ok_or_else(|| {
        PyValueError::new_err(
            "down and field do not determine a rotation: give 12 attitudes or more, in all \
             directions",
        )
    })?;
    Ok(fit.rotation.0)
}

/// The rows of an array (n, 3).
fn axes(name: &str, from: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 3]>> {
    let (shape, values) = numbers(name, from)?;
    match shape.as_slice() {
        [_, 3] => Ok(values.as_chunks::<3>().0.to_vec()),
        _ => Err(PyValueError::new_err(format!(
            "{name} is of shape {}: give (n, 3)",
            shape_words(&shape)
        ))),
    }
}
