//! The calibration of a sensor of three axes, from arrays.

use fcc_calibration::{
    Axes, AxesCalibration, GuidedCalibration, GuidedKind, Rotation, Values, fit_strength,
};
use fcc_core::flight::{BodyRates, Measurements, SpecificForce};
use fcc_core::framework::Reading;
use fcc_navigation::inertial::Observation;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{finite, numbers, shape_words, vector};
use crate::navigate::inertial_samples;

/// Bias, scale and misalignment by which all samples have one `strength`:
/// gravity's in m/s² of an accelerometer at rest, the field's in µT of a
/// magnetometer. `samples` is (n, 3), in the sensor's axes, of many directions.
///
/// Returns a dict with `bias`, `scale` and `misalignment` as in the
/// configuration's `calibration`, `matrix` (3 rows: scale and misalignment, of what
/// is given less the bias), `residual` (RMS of what is left), `bias_sigma`,
/// and `spread` (the least share of the directions along any axis: a third is the
/// best). Raises `ValueError` with the reason if there is no calibration.
///
/// >>> rng = np.random.default_rng(1)
/// >>> directions = rng.normal(size=(500, 3))
/// >>> directions /= np.linalg.norm(directions, axis=1, keepdims=True)
/// >>> noise = rng.normal(0.0, 0.01, size=(500, 3))
/// >>> found = fcc.calibrate(9.81 * directions + [0.1, 0.0, -0.2] + noise, 9.81)
/// >>> [round(float(one), 1) + 0.0 for one in found["bias"]]
/// [0.1, 0.0, -0.2]
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
    let found = of_axes(py, &fit.axes)?;
    found.set_item("residual", fit.residual)?;
    found.set_item("bias_sigma", fit.bias_sigma)?;
    found.set_item("spread", fit.spread)?;
    Ok(found)
}

/// Bias, scale and misalignment of a gyroscope that was left alone for 11 s and
/// then turned by quarter and half turns about each of its axes, with 3 s of rest
/// after each: after a turn gravity has the direction that it had before,
/// turned by the integrated rates. Both are tuples of times in s and values
/// (n, 3): rates in rad/s as the gyroscope gives them, and the specific force in
/// m/s² of an accelerometer that is calibrated, in axes along the gyroscope's.
///
/// Returns a dict with `bias` (rad/s), `scale` and `misalignment` as in the
/// configuration's `calibration`, `matrix` (3 rows: scale and misalignment, of what
/// is given less the bias), `residual_rad` (RMS of the angles by which gravity's
/// directions still differ), `sigma` (of the worst of scale and misalignment) and
/// `bias_sigma`. Raises `ValueError` with the reason if there is no calibration.
///
/// >>> t = np.arange(0.0, 12.0, 0.01)
/// >>> still, up = np.zeros((t.size, 3)), np.tile([0.0, 0.0, -9.81], (t.size, 1))
/// >>> fcc.calibrate_gyroscope(gyroscope=(t, still), accelerometer=(t, up))
/// Traceback (most recent call last):
///     ...
/// ValueError: it was ended too early: 0 of 3 are there
#[pyfunction]
#[pyo3(signature = (*, gyroscope, accelerometer))]
pub(crate) fn calibrate_gyroscope<'py>(
    py: Python<'py>,
    gyroscope: Bound<'py, PyAny>,
    accelerometer: Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let samples = inertial_samples(gyroscope, accelerometer)?;
    let found = py.detach(|| {
        let mut calibration = Box::new(GuidedCalibration::new(&GuidedKind::Gyroscope {
            accelerometer: Axes::default(),
            turn: Rotation::NONE,
        }));
        let mut measured = Measurements::default();
        for (taken, observation) in samples {
            match observation {
                Observation::Rates([roll_radps, pitch_radps, yaw_radps]) => {
                    let rates = BodyRates {
                        roll_radps,
                        pitch_radps,
                        yaw_radps,
                    };
                    measured.raw_body_rates = Reading::new(rates, taken);
                }
                Observation::SpecificForce([x_mps2, y_mps2, z_mps2]) => {
                    let force = SpecificForce {
                        x_mps2,
                        y_mps2,
                        z_mps2,
                    };
                    measured.raw_specific_force = Reading::new(force, taken);
                }
                _ => continue,
            }
            calibration.take(&measured);
        }
        calibration.finish()
    });
    let found = found.map_err(|refusal| PyValueError::new_err(refusal.to_string()))?;
    let Values::Gyroscope {
        axes,
        residual_rad,
        bias_sigma_radps,
    } = found.values
    else {
        return Err(PyValueError::new_err(
            "this is no calibration of a gyroscope",
        ));
    };
    let dict = of_axes(py, &axes)?;
    dict.set_item("residual_rad", residual_rad)?;
    dict.set_item("sigma", found.sigma)?;
    dict.set_item("bias_sigma", bias_sigma_radps)?;
    Ok(dict)
}

/// Bias, scale and misalignment, and the matrix of both.
fn of_axes<'py>(py: Python<'py>, axes: &Axes) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("bias", axes.bias)?;
    found.set_item("scale", axes.scale)?;
    found.set_item("misalignment", axes.misalignment)?;
    found.set_item("matrix", AxesCalibration::new(axes).matrix())?;
    Ok(found)
}

/// The smallest rotation, as a matrix of three rows, after which the specific
/// force of a level aircraft at rest points up. Raises `ValueError` if it points
/// down.
///
/// >>> np.round(fcc.levelled([0.0, 0.0, -9.81]), 3).tolist()
/// [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
#[pyfunction]
pub(crate) fn levelled(force_mps2: &Bound<'_, PyAny>) -> PyResult<[[f64; 3]; 3]> {
    let force = vector("force_mps2", force_mps2)?;
    let Some(Rotation(rows)) = fcc_calibration::levelled(force) else {
        return Err(PyValueError::new_err(
            "force_mps2 does not point up: the sensor is mounted in another way",
        ));
    };
    Ok(rows)
}

/// The rotation of sensors in the aircraft, as a matrix of three rows from their
/// axes to the body's, by the specific force of the aircraft at rest: level, and
/// with its nose raised. Raises `ValueError` if both are parallel.
///
/// >>> level, nose_up = [0.0, 0.0, -9.81], [1.7, 0.0, -9.66]
/// >>> (np.round(fcc.level_and_nose_up(level, nose_up), 3) + 0.0).tolist()
/// [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
#[pyfunction]
pub(crate) fn level_and_nose_up(
    level_mps2: &Bound<'_, PyAny>,
    nose_up_mps2: &Bound<'_, PyAny>,
) -> PyResult<[[f64; 3]; 3]> {
    let level = vector("level_mps2", level_mps2)?;
    let nose_up = vector("nose_up_mps2", nose_up_mps2)?;
    let Some(Rotation(rows)) = fcc_calibration::level_and_nose_up(level, nose_up) else {
        return Err(PyValueError::new_err(
            "level_mps2 and nose_up_mps2 are parallel: raise the nose by 20° or more",
        ));
    };
    Ok(rows)
}

/// The rotation of a magnetometer, as a matrix of three rows, after which the
/// field has the same dip in all attitudes: `down` and `field` are (n, 3), of the
/// same instants. Raises `ValueError` if they do not determine it.
///
/// >>> rng = np.random.default_rng(1)
/// >>> down, across = np.linalg.qr(rng.normal(size=(20, 3, 2)))[0].transpose(2, 0, 1)
/// >>> found = np.array(fcc.constant_dip(down, 43.0 * down + 21.0 * across))
/// >>> (found.round(3) + 0.0).tolist()
/// [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
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
    let fit = fcc_calibration::constant_dip(down.into_iter().zip(field)).ok_or_else(|| {
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
