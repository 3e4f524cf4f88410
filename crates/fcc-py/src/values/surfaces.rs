//! Throttle and surfaces.

use fcc_core::flight::Surfaces;
use numpy::{PyArray1, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// What the columns of a series of surfaces are.
pub(crate) const SURFACE_COLUMNS: [&str; 4] = ["throttle", "elevator", "aileron", "rudder"];

/// Throttle 0..1 and surfaces -1..1: +elevator raises the nose, +aileron rolls
/// right, +rudder yaws right.
#[pyclass(name = "Surfaces", module = "fcc", frozen, get_all)]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct PySurfaces {
    throttle: f64,
    elevator: f64,
    aileron: f64,
    rudder: f64,
}

impl From<Surfaces> for PySurfaces {
    fn from(surfaces: Surfaces) -> Self {
        Self {
            throttle: surfaces.throttle,
            elevator: surfaces.elevator,
            aileron: surfaces.aileron,
            rudder: surfaces.rudder,
        }
    }
}

impl PySurfaces {
    pub(crate) const fn to_core(self) -> Surfaces {
        Surfaces {
            throttle: self.throttle,
            elevator: self.elevator,
            aileron: self.aileron,
            rudder: self.rudder,
        }
    }
}

/// Surfaces, each in its range.
pub(crate) fn checked_surfaces(surfaces: Surfaces) -> PyResult<Surfaces> {
    if surfaces.is_valid() {
        return Ok(surfaces);
    }
    Err(PyValueError::new_err(format!(
        "the controls stand at {surfaces:?}: throttle is 0 to 1, the others -1 to 1"
    )))
}

#[pymethods]
impl PySurfaces {
    #[new]
    #[pyo3(signature = (*, throttle, elevator = 0.0, aileron = 0.0, rudder = 0.0))]
    fn new(throttle: f64, elevator: f64, aileron: f64, rudder: f64) -> PyResult<Self> {
        checked_surfaces(Surfaces {
            throttle,
            elevator,
            aileron,
            rudder,
        })
        .map(Self::from)
    }

    /// As a row of 4 numbers: throttle, elevator, aileron, rudder.
    #[pyo3(name = "to_array")]
    fn array<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        [self.throttle, self.elevator, self.aileron, self.rudder].to_pyarray(py)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self == other
    }

    fn __repr__(&self) -> String {
        format!(
            "Surfaces(throttle={:.3}, elevator={:+.3}, aileron={:+.3}, rudder={:+.3})",
            self.throttle, self.elevator, self.aileron, self.rudder
        )
    }
}
