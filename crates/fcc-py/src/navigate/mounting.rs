//! How inertial sensors and magnetometers are mounted.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{numbers, shape_words};

/// What may be mounted otherwise than along the body's axes.
pub(super) const SENSORS: [&str; 3] = ["gyroscope", "accelerometer", "magnetometer"];
/// By how much the rows of a rotation matrix may be wrong.
const ROUNDING: f64 = 1e-3;

type Matrix = [[f64; 3]; 3];

const ALONG: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A rotation matrix for each of the sensors: from its axes to the body's.
#[derive(Debug)]
pub(super) struct Mounting([Matrix; 3]);

impl Mounting {
    /// One rotation for all, or a dict of one for each.
    pub(super) fn read(given: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let mut mounting = Self([ALONG; 3]);
        let Some(given) = given else {
            return Ok(mounting);
        };
        let Ok(each) = given.cast::<PyDict>() else {
            return Ok(Self([matrix("mounting", given)?; 3]));
        };
        for (name, rotation) in each {
            let name: String = name
                .extract()
                .map_err(|_| unknown("a key that is no str"))?;
            let at = SENSORS.iter().position(|sensor| *sensor == name);
            let place = at.and_then(|at| mounting.0.get_mut(at));
            *place.ok_or_else(|| unknown(&name))? =
                matrix(&format!("mounting[{name:?}]"), &rotation)?;
        }
        Ok(mounting)
    }

    /// A vector in the body's axes.
    pub(super) fn body(&self, sensor: &str, vector: [f64; 3]) -> [f64; 3] {
        let at = SENSORS.iter().position(|name| *name == sensor);
        match at.and_then(|at| self.0.get(at)) {
            Some(matrix) => matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum()),
            None => vector,
        }
    }
}

fn unknown(name: &str) -> PyErr {
    PyValueError::new_err(format!(
        "mounting has {name}: choose of {}",
        SENSORS.join(", ")
    ))
}

/// A rotation matrix, 3 × 3, or a quaternion [w, x, y, z], from the sensor's axes
/// to the body's.
fn matrix(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Matrix> {
    let (shape, values) = numbers(name, given)?;
    let matrix = match (shape.as_slice(), values.as_slice()) {
        ([3, 3], [a, b, c, d, e, f, g, h, i]) => [[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]],
        ([4], [w, x, y, z]) => from_quaternion([*w, *x, *y, *z]),
        _ => {
            return Err(PyValueError::new_err(format!(
                "{name} is of shape {}: give a rotation matrix (3, 3) or a quaternion \
                 [w, x, y, z], from the sensor's axes to the body's",
                shape_words(&shape)
            )));
        }
    };
    if is_rotation(&matrix) {
        return Ok(matrix);
    }
    Err(PyValueError::new_err(format!(
        "{name} is no rotation: its rows must be of length 1, square to each other and \
         right-handed (determinant 1)"
    )))
}

fn from_quaternion(q: [f64; 4]) -> Matrix {
    let length = q.iter().map(|part| part * part).sum::<f64>().sqrt();
    let [w, x, y, z] = q.map(|part| part / length);
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

fn is_rotation([a, b, c]: &Matrix) -> bool {
    let dot = |u: &[f64; 3], v: &[f64; 3]| u.iter().zip(v).map(|(a, b)| a * b).sum::<f64>();
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    let third = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    let near = |found: f64, expected: f64| (found - expected).abs() <= ROUNDING;
    near(dot(a, a), 1.0)
        && near(dot(b, b), 1.0)
        && near(dot(a, b), 0.0)
        && third
            .iter()
            .zip(c)
            .all(|(found, expected)| near(*found, *expected))
}
