//! Checks of arguments: every error names the argument, its value and what is
//! permitted.

use fcc_telemetry::units;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::values::{Values, names};

/// The longest step of a control loop, s.
const MAX_STEP_S: f64 = 1.0;

/// A time step in s: above 0, at most 1.
pub(crate) fn step_s(dt: f64) -> PyResult<f64> {
    if dt > 0.0 && dt <= MAX_STEP_S {
        return Ok(dt);
    }
    Err(PyValueError::new_err(format!(
        "dt is {dt} s: it must be above 0 and at most {MAX_STEP_S}"
    )))
}

/// A finite number.
pub(crate) fn finite(name: &str, value: f64) -> PyResult<f64> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(PyValueError::new_err(format!(
        "{name} is {value}: it must be a finite number"
    )))
}

/// A finite number in a range.
pub(crate) fn within(name: &str, value: f64, least: f64, most: f64) -> PyResult<f64> {
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    Err(PyValueError::new_err(format!(
        "{name} is {}: choose {least} to {most}",
        units::number(value)
    )))
}

/// A whole number that is drawn by.
pub(crate) fn seed(name: &str, given: &Bound<'_, PyAny>) -> PyResult<u64> {
    given.extract().map_err(|error: PyErr| {
        let message = format!(
            "{name} is {given}: choose a whole number, 0 to {}",
            u64::MAX
        );
        if error.is_instance_of::<PyOverflowError>(given.py()) {
            PyValueError::new_err(message)
        } else {
            PyTypeError::new_err(message)
        }
    })
}

/// Anything that numpy converts to an array of numbers: its shape and its
/// values, row by row.
pub(crate) fn numbers(name: &str, from: &Bound<'_, PyAny>) -> PyResult<(Vec<usize>, Vec<f64>)> {
    let py = from.py();
    let numpy = py.import("numpy")?;
    let refused = |why: &dyn std::fmt::Display| {
        PyTypeError::new_err(format!("{name} is not an array of numbers: {why}"))
    };
    let array = numpy
        .call_method1("asarray", (from,))
        .map_err(|error| refused(&error.value(py)))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u") {
        let dtype = array.getattr("dtype")?.str()?;
        return Err(refused(&format_args!("its dtype is {dtype}")));
    }
    // Not `ascontiguousarray`, which makes an array of one of a single number.
    let array = numpy.call_method1("asarray", (&array, "float64", "C"))?;
    let array = array.cast::<PyArrayDyn<f64>>()?;
    let values = array.readonly().as_slice()?.to_vec();
    Ok((array.shape().to_vec(), values))
}

/// An array with a column for each value of a class, in the order of `columns`;
/// its numbers, row by row.
pub(crate) fn rows<V: Values>(
    name: &str,
    columns: &str,
    from: &Bound<'_, PyAny>,
) -> PyResult<Rows> {
    let (shape, numbers) = numbers(name, from)?;
    let width = names::<V>().count();
    match shape.as_slice() {
        [_, n] if *n == width => Ok(Rows { numbers, width }),
        _ => Err(PyValueError::new_err(format!(
            "{name} is of shape {}: give (n, {width}), the columns being {columns}",
            shape_words(&shape)
        ))),
    }
}

/// The numbers of an array, row by row.
pub(crate) struct Rows {
    numbers: Vec<f64>,
    width: usize,
}

impl Rows {
    /// Calls a function for each row, without the GIL. After each piece of rows,
    /// which takes a fraction of a second, it checks for Ctrl-C.
    pub(crate) fn in_pieces(
        &self,
        py: Python<'_>,
        mut act: impl FnMut(&[f64]) + Send,
    ) -> PyResult<()> {
        const ROWS: usize = 4_096;
        for piece in self.numbers.chunks(ROWS * self.width.max(1)) {
            py.detach(|| piece.chunks_exact(self.width.max(1)).for_each(&mut act));
            py.check_signals()?;
        }
        Ok(())
    }

    pub(crate) fn iter(&self) -> std::slice::ChunksExact<'_, f64> {
        self.numbers.chunks_exact(self.width.max(1))
    }
}

/// A vector of `N` numbers.
pub(crate) fn vector<const N: usize>(name: &str, from: &Bound<'_, PyAny>) -> PyResult<[f64; N]> {
    let (shape, values) = numbers(name, from)?;
    let wrong = || {
        PyValueError::new_err(format!(
            "{name} is of shape {}: give ({N},)",
            shape_words(&shape)
        ))
    };
    if shape.len() != 1 {
        return Err(wrong());
    }
    let vector: [f64; N] = values.try_into().map_err(|_| wrong())?;
    for (at, value) in vector.iter().enumerate() {
        finite(&format!("{name}[{at}]"), *value)?;
    }
    Ok(vector)
}

/// A shape as Python prints it.
pub(crate) fn shape_words(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        many => {
            let many: Vec<_> = many.iter().map(ToString::to_string).collect();
            format!("({})", many.join(", "))
        }
    }
}
