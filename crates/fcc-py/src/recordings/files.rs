//! The daemon's commands for recordings of any plant: list, recover.

#![expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]

use std::path::PathBuf;

use fcc_record::Listed;
use pyo3::prelude::*;

use crate::errors;
use crate::json;

/// The recordings in a folder, oldest first, each as a dict. A file that cannot
/// be read has only the keys `path` and `error`.
///
/// >>> [one["path"] for one in fcc.list_recordings("recordings")]
/// ['recordings/flight.mcap']
#[pyfunction]
pub(crate) fn list_recordings(py: Python<'_>, folder: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let listed = py.detach(|| -> Result<Vec<Listed>, String> {
        let files = fcc_record::files(&folder).map_err(|error| {
            format!(
                "{}: cannot be listed: {error}. Give the folder that flights were recorded to",
                folder.display()
            )
        })?;
        let listed = files.into_iter().map(|file| Listed::of(file, false));
        Ok(listed.collect())
    });
    json::to_python(py, &listed.map_err(|words| errors::RECORDING.with(words))?)
}

/// Replaces a recording that was cut off or damaged by a whole one; a whole one
/// is unchanged. Returns the result as a dict.
///
/// >>> fcc.recover("recordings/flight.mcap")["was_whole"]
/// True
#[pyfunction]
pub(crate) fn recover(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let recovered = py
        .detach(|| fcc_record::recover(&path, |_| {}))
        .map_err(|error| errors::RECORDING.with(error))?;
    json::to_python(py, &recovered)
}
