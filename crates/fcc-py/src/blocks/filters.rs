//! Filters, a rate limiter, the square-root profile.

use fcc_core::blocks::{Complementary, HighPass, LowPass, RateLimit, SquareRootProfile};
use numpy::{PyArray1, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::{not_negative, passed_s, positive};
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

/// Declares a class around a block that gives an output for each input.
macro_rules! filter_class {
    (
        $(#[$meta:meta])*
        struct $name:ident($block:ident), new($new:ident: $check:ident), reset($reset:ident);
        $($methods:tt)*
    ) => {
        $(#[$meta])*
        pub(crate) struct $name($block);

        #[pymethods]
        impl $name {
            #[new]
            fn new($new: f64) -> PyResult<Self> {
                Ok(Self($block::new($check(stringify!($new), $new)?)))
            }

            /// Takes an input held for `dt` s; returns the output.
            fn step(&mut self, value: f64, dt: f64) -> PyResult<f64> {
                Ok(self.0.step(finite("value", value)?, passed_s(dt)?))
            }

            /// Takes a series of inputs, each held for `dt` s; returns the
            /// outputs.
            fn run<'py>(
                &mut self,
                py: Python<'py>,
                inputs: &Bound<'py, PyAny>,
                dt: f64,
            ) -> PyResult<Bound<'py, PyArray1<f64>>> {
                let (inputs, dt_s) = (self::inputs(inputs)?, passed_s(dt)?);
                let outputs: Vec<f64> =
                    py.detach(|| inputs.iter().map(|input| self.0.step(*input, dt_s)).collect());
                Ok(outputs.to_pyarray(py))
            }

            /// Resets to a steady output; a high pass, to a steady input.
            fn reset(&mut self, $reset: f64) -> PyResult<()> {
                self.0.reset(finite(stringify!($reset), $reset)?);
                Ok(())
            }

            $($methods)*
        }
    };
}

filter_class! {
    /// First-order low pass with a time constant in s (0 for none); its initial
    /// output is its first input.
    ///
    /// >>> low_pass = fcc.LowPass(1.0)
    /// >>> low_pass.reset(0.0)
    /// >>> round(low_pass.step(1.0, 1.0), 4)  # 1 - 1/e
    /// 0.6321
    #[pyclass(name = "LowPass", module = "fcc")]
    struct PyLowPass(LowPass), new(tau_s: not_negative), reset(output);

    /// The output, 0 before any input.
    #[getter]
    fn output(&self) -> f64 {
        self.0.output()
    }
}

filter_class! {
    /// First-order high pass with a time constant in s: the input minus its low
    /// pass.
    ///
    /// >>> fcc.HighPass(1.0).run(np.ones(3), 0.1)
    /// array([0., 0., 0.])
    #[pyclass(name = "HighPass", module = "fcc")]
    struct PyHighPass(HighPass), new(tau_s: not_negative), reset(constant);
}

filter_class! {
    /// Limits the rate of change of a signal, in units per second; its initial
    /// output is its first input.
    ///
    /// >>> fcc.RateLimit(2.0).run([0.0, 10.0, 10.0], 0.5)
    /// array([0., 1., 2.])
    #[pyclass(name = "RateLimit", module = "fcc")]
    struct PyRateLimit(RateLimit), new(rate_per_s: positive), reset(output);
}

/// First-order complementary filter: integrates a rate, and is corrected by a
/// measurement with a time constant in s.
///
/// >>> angle = fcc.Complementary(1.0)
/// >>> angle.reset(0.0)
/// >>> angle.predict(0.1, 1.0)
/// >>> round(angle.value, 3)
/// 0.1
#[pyclass(name = "Complementary", module = "fcc")]
pub(crate) struct PyComplementary(Complementary);

#[pymethods]
impl PyComplementary {
    #[new]
    fn new(tau_s: f64) -> PyResult<Self> {
        Ok(Self(Complementary::new(not_negative("tau_s", tau_s)?)))
    }

    /// Integrates a rate (units per second) for `dt` s.
    fn predict(&mut self, rate: f64, dt: f64) -> PyResult<()> {
        self.0.predict(finite("rate", rate)?, passed_s(dt)?);
        Ok(())
    }

    /// Corrects by a measurement taken `dt` s after the previous one.
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

/// The closing speed for an error from which a constant deceleration reaches
/// the target: proportional to the error near the target (`gain_per_s`, 1/s),
/// to its square root further away (`deceleration`, units/s²).
///
/// >>> fcc.SquareRootProfile(1.0, 2.0).speed(0.5)
/// 0.5
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
