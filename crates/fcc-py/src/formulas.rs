//! Formulas of the core: standard atmosphere, orientation, angles.
//!
//! Those of one or two numbers return a `float` for a number, and an array of
//! the same shape for an array. As in numpy, an array without dimensions is a
//! number.

use fcc_core::blocks;
use fcc_core::flight::atmosphere;
use fcc_core::flight::orientation::{self, EulerAngles};
use numpy::{PyArray1, PyArrayMethods, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arguments::{finite, numbers, shape_words, vector, within};

/// The highest altitude that a formula accepts, m; above 11,000 m the values
/// are those of the tropopause.
const HIGHEST_M: f64 = 20_000.0;
/// Below the Dead Sea.
const LOWEST_M: f64 = -500.0;
/// Pressures that a formula accepts, Pa.
const PRESSURE_PA: (f64, f64) = (1_000.0, 120_000.0);

/// A formula of one number, for a number or an array.
fn each<'py>(
    name: &str,
    given: &Bound<'py, PyAny>,
    check: impl Fn(&str, f64) -> PyResult<f64>,
    formula: impl Fn(f64) -> f64,
) -> PyResult<Bound<'py, PyAny>> {
    let py = given.py();
    let (shape, values) = numbers(name, given)?;
    let mut results = Vec::with_capacity(values.len());
    for value in values {
        results.push(formula(check(name, value)?));
    }
    match (shape.as_slice(), results.as_slice()) {
        ([], [one]) => Ok(one.into_pyobject(py)?.into_any()),
        _ => Ok(results.to_pyarray(py).reshape(shape)?.into_any()),
    }
}

fn altitude(name: &str, altitude_m: f64) -> PyResult<f64> {
    within(name, altitude_m, LOWEST_M, HIGHEST_M)
}

/// Static pressure in Pa at a pressure altitude in m, -500 to 20,000 (ISO
/// 2533:1975; above 11,000 m that of 11,000 m).
///
/// >>> round(fcc.pressure_pa(1_000.0))
/// 89875
#[pyfunction]
pub(crate) fn pressure_pa<'py>(altitude_m: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    each("altitude_m", altitude_m, altitude, atmosphere::pressure_pa)
}

/// Pressure altitude in m from static pressure in Pa, 1,000 to 120,000.
///
/// >>> round(fcc.pressure_altitude_m(89_875.0))
/// 1000
#[pyfunction]
pub(crate) fn pressure_altitude_m<'py>(
    pressure_pa: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let check = |name: &str, pa| within(name, pa, PRESSURE_PA.0, PRESSURE_PA.1);
    each(
        "pressure_pa",
        pressure_pa,
        check,
        atmosphere::pressure_altitude_m,
    )
}

/// Air density over its sea-level value (1.225 kg/m³) at a pressure altitude
/// in m, -500 to 20,000.
///
/// >>> fcc.density_ratio([0.0, 5_000.0]).round(3)
/// array([1.   , 0.601])
#[pyfunction]
pub(crate) fn density_ratio<'py>(altitude_m: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    each(
        "altitude_m",
        altitude_m,
        altitude,
        atmosphere::density_ratio,
    )
}

/// True airspeed in m/s from equivalent airspeed in m/s at a pressure altitude
/// in m.
///
/// >>> round(fcc.true_airspeed_mps(50.0, 3_000.0), 1)
/// 58.0
#[pyfunction]
pub(crate) fn true_airspeed_mps<'py>(
    equivalent_mps: &Bound<'py, PyAny>,
    altitude_m: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let altitude_m = altitude("altitude_m", altitude_m)?;
    each("equivalent_mps", equivalent_mps, finite, |mps| {
        atmosphere::true_airspeed_mps(mps, altitude_m)
    })
}

/// The angle wrapped to -π..π, rad.
///
/// >>> round(fcc.wrap_pi(4.0), 4)
/// -2.2832
#[pyfunction]
pub(crate) fn wrap_pi<'py>(angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    each("angle_rad", angle_rad, finite, blocks::wrap_pi)
}

/// The angle wrapped to 0..2π, rad.
///
/// >>> round(fcc.wrap_two_pi(-1.0), 4)
/// 5.2832
#[pyfunction]
pub(crate) fn wrap_two_pi<'py>(angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    each("angle_rad", angle_rad, finite, blocks::wrap_two_pi)
}

/// The quaternion [w, x, y, z] from body axes (forward, right, down) to earth
/// axes (north, east, down), for roll, pitch and heading in rad.
///
/// >>> fcc.quaternion_from_euler(0.0, 0.0, np.pi).round(6)
/// array([0., 0., 0., 1.])
#[pyfunction]
pub(crate) fn quaternion_from_euler(
    py: Python<'_>,
    roll_rad: f64,
    pitch_rad: f64,
    heading_rad: f64,
) -> PyResult<Bound<'_, PyArray1<f64>>> {
    let quaternion = orientation::quaternion_from_euler(EulerAngles {
        roll_rad: finite("roll_rad", roll_rad)?,
        pitch_rad: finite("pitch_rad", pitch_rad)?,
        heading_rad: finite("heading_rad", heading_rad)?,
    });
    Ok(quaternion.to_pyarray(py))
}

/// Roll, pitch and heading in rad of a quaternion [w, x, y, z] of any length.
///
/// >>> fcc.euler_from_quaternion([1.0, 0.0, 0.0, 0.0])
/// (0.0, 0.0, 0.0)
#[pyfunction]
pub(crate) fn euler_from_quaternion(quaternion: &Bound<'_, PyAny>) -> PyResult<(f64, f64, f64)> {
    let angles = orientation::euler_from_quaternion(self::quaternion(quaternion)?);
    Ok((angles.roll_rad, angles.pitch_rad, angles.heading_rad))
}

/// A vector in body axes (forward, right, down), in earth axes (north, east,
/// down). `vector` is of shape (3,) or (n, 3).
///
/// >>> east = fcc.quaternion_from_euler(0.0, 0.0, np.pi / 2)
/// >>> fcc.body_to_earth(east, [1.0, 0.0, 0.0]).round(6)
/// array([0., 1., 0.])
#[pyfunction]
pub(crate) fn body_to_earth<'py>(
    quaternion: &Bound<'py, PyAny>,
    vector: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let quaternion = self::quaternion(quaternion)?;
    turned(vector, |v| orientation::body_to_earth(quaternion, v))
}

/// A vector in earth axes (north, east, down), in body axes (forward, right,
/// down). `vector` is of shape (3,) or (n, 3).
///
/// >>> east = fcc.quaternion_from_euler(0.0, 0.0, np.pi / 2)
/// >>> fcc.earth_to_body(east, [0.0, 1.0, 0.0]).round(6)
/// array([1., 0., 0.])
#[pyfunction]
pub(crate) fn earth_to_body<'py>(
    quaternion: &Bound<'py, PyAny>,
    vector: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let quaternion = self::quaternion(quaternion)?;
    turned(vector, |v| orientation::earth_to_body(quaternion, v))
}

/// A quaternion that is not of length 0.
fn quaternion(given: &Bound<'_, PyAny>) -> PyResult<[f64; 4]> {
    let quaternion: [f64; 4] = vector("quaternion", given)?;
    let length = quaternion
        .iter()
        .map(|part| part * part)
        .sum::<f64>()
        .sqrt();
    if !(1e-6..1e6).contains(&length) {
        return Err(PyValueError::new_err(format!(
            "quaternion has the length {length}: it must be between 1e-6 and 1e6"
        )));
    }
    Ok(quaternion)
}

fn turned<'py>(
    given: &Bound<'py, PyAny>,
    turn: impl Fn([f64; 3]) -> [f64; 3],
) -> PyResult<Bound<'py, PyAny>> {
    let (shape, values) = numbers("vector", given)?;
    if !matches!(shape.as_slice(), [3] | [_, 3]) {
        return Err(PyValueError::new_err(format!(
            "vector is of shape {}: give (3,) or (n, 3)",
            shape_words(&shape)
        )));
    }
    for value in &values {
        finite("vector", *value)?;
    }
    let (vectors, _) = values.as_chunks::<3>();
    let turned: Vec<f64> = vectors.iter().flat_map(|v| turn(*v)).collect();
    Ok(turned.to_pyarray(given.py()).reshape(shape)?.into_any())
}
