//! A running daemon: watching it, and sending commands.

mod commander;
mod watcher;

pub(crate) use commander::PyCommander;
pub(crate) use watcher::PyWatcher;

use fcc_telemetry::Instance;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A daemon's name.
fn instance(name: &str) -> PyResult<Instance> {
    name.parse()
        .map_err(|error: fcc_telemetry::InstanceError| PyValueError::new_err(error.to_string()))
}
