//! What is true of the built-in aircraft, as no sensor measures it.

use fcc_sim::{TRUTH_NUMBERS, Truth};
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;

/// The numbers of a truth, in the order of its names.
pub(crate) type TruthRow = [f64; TRUTH_NUMBERS];

/// What is true of the built-in aircraft at one moment, as no sensor measures
/// it: for scoring, never for flying.
///
/// Its attributes are `fcc.TRUTH`, with the unit at the end of each; `heading_rad`
/// is the true one, `altitude_m` above mean sea level, `north_m` and `east_m`
/// from where the flight began, `elevator_rad` positive trailing edge down.
#[pyclass(name = "Truth", module = "fcc", frozen)]
#[derive(Clone, Copy)]
pub(crate) struct PyTruth(pub(crate) Truth);

#[pymethods]
impl PyTruth {
    fn __getattr__(&self, name: &str) -> PyResult<f64> {
        Truth::NAMES
            .iter()
            .zip(self.0.to_array())
            .find(|(known, _)| **known == name)
            .map(|(_, value)| value)
            .ok_or_else(|| PyAttributeError::new_err(format!("'Truth' has no '{name}'")))
    }

    #[expect(clippy::unused_self, reason = "Python asks the instance")]
    fn __dir__(&self) -> Vec<&'static str> {
        Truth::NAMES.to_vec()
    }

    fn __repr__(&self) -> String {
        let fields: Vec<_> = Truth::NAMES
            .iter()
            .zip(self.0.to_array())
            .map(|(name, value)| format!("{name}={value}"))
            .collect();
        format!("Truth({})", fields.join(", "))
    }
}
