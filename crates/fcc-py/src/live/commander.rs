//! Orders to a running daemon.

use std::sync::{Mutex, PoisonError};

use fcc_telemetry::Instance;
use fcc_telemetry::live::{Commander, FlightOrder, NewSetpoints, OrderError};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::instance;
use crate::errors;

/// Gives orders to a daemon on this machine, by its instance's name. Each call
/// waits until the order is carried out and returns the tick that did; the GIL
/// is released meanwhile.
///
/// Raises `OrderError` with the daemon's reason if it refuses, and
/// `TelemetryError` if it cannot be reached.
#[pyclass(name = "Commander", module = "fcc")]
pub(crate) struct PyCommander {
    commander: Mutex<Commander>,
    instance: Instance,
}

fn refused(error: &OrderError) -> PyErr {
    match error {
        OrderError::Unreachable(_) | OrderError::TakesNone { .. } => errors::TELEMETRY.say(error),
        _ => errors::ORDER.say(error),
    }
}

#[pymethods]
impl PyCommander {
    #[new]
    #[pyo3(signature = (instance = "fccd"))]
    fn new(py: Python<'_>, instance: &str) -> PyResult<Self> {
        let instance = self::instance(instance)?;
        let commander = py
            .detach(|| Commander::open(&instance))
            .map_err(|error| refused(&error))?;
        Ok(Self {
            commander: Mutex::new(commander),
            instance,
        })
    }

    /// Take over as things are.
    fn engage(&self, py: Python<'_>) -> PyResult<u64> {
        self.order(py, FlightOrder::Engage)
    }

    /// Give the controls back.
    fn disengage(&self, py: Python<'_>) -> PyResult<u64> {
        self.order(py, FlightOrder::Disengage)
    }

    /// Give the controls back and end the daemon.
    fn stop(&self, py: Python<'_>) -> PyResult<u64> {
        self.order(py, FlightOrder::Stop)
    }

    /// Fly by other set points, those that are not given staying: indicated
    /// airspeed (m/s, 5 to 340), magnetic heading (rad, -2π to 2π), barometric
    /// altitude (m, -500 to 20,000). Ends a pattern.
    #[pyo3(signature = (*, airspeed_mps = None, heading_rad = None, altitude_m = None))]
    fn set(
        &self,
        py: Python<'_>,
        airspeed_mps: Option<f64>,
        heading_rad: Option<f64>,
        altitude_m: Option<f64>,
    ) -> PyResult<u64> {
        let order = FlightOrder::Set(NewSetpoints {
            airspeed_mps,
            heading_rad,
            altitude_m,
        });
        order.check().map_err(PyValueError::new_err)?;
        self.order(py, order)
    }

    fn __repr__(&self) -> String {
        format!("Commander({:?})", self.instance.to_string())
    }
}

impl PyCommander {
    fn order(&self, py: Python<'_>, order: FlightOrder) -> PyResult<u64> {
        py.detach(|| {
            let mut commander = self
                .commander
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            commander.order(order)
        })
        .map_err(|error| refused(&error))
    }
}
