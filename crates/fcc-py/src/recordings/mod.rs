//! Recordings: of any plant read into numpy, listed and recovered; replayed by
//! the program that has their types; flights reported.

mod files;
#[cfg(feature = "flight")]
mod flight;
mod frame;
mod reading;
mod replay;

#[cfg(feature = "flight")]
pub(crate) use flight::{replay as replay_flight, report};
pub use replay::{loop_of, replay};

use pyo3::prelude::*;

/// Adds to a module what is for recordings of any plant: `Recording`,
/// `list_recordings`, `recover`.
///
/// # Errors
/// Those of Python.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<reading::PyRecording>()?;
    module.add_function(wrap_pyfunction!(files::list_recordings, module)?)?;
    module.add_function(wrap_pyfunction!(files::recover, module)?)
}
