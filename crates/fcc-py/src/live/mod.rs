//! A running loop of any plant: watched, and given commands.

mod commander;
mod watcher;

use fcc_telemetry::Instance;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Adds to a module the classes for any plant: `Watcher`, `Commander`.
///
/// # Errors
/// Those of Python.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<watcher::PyWatcher>()?;
    module.add_class::<commander::PyCommander>()
}

/// A daemon's name.
fn instance(name: &str) -> PyResult<Instance> {
    name.parse()
        .map_err(|error: fcc_telemetry::InstanceError| PyValueError::new_err(error.to_string()))
}
