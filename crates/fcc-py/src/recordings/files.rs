//! What the daemon's commands do with recordings of any plant: list, recover.

#![expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]

use std::path::PathBuf;

use pyo3::prelude::*;
use serde::Serialize;

use crate::errors;
use crate::json;

/// The recordings in a folder, oldest first, each as a dict. What is no
/// recording has the keys `path` and `error` alone.
#[pyfunction]
pub(crate) fn list_recordings(py: Python<'_>, folder: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    #[derive(Serialize)]
    #[serde(untagged)]
    enum Listed {
        Entry(fcc_record::Entry),
        Not {
            #[serde(serialize_with = "fcc_record::serialize_path")]
            path: PathBuf,
            error: String,
        },
    }
    let listed = py.detach(|| -> Result<Vec<Listed>, String> {
        let files = fcc_record::files(&folder).map_err(|error| {
            format!(
                "{}: cannot be listed: {error}. Give the folder that flights were recorded to",
                folder.display()
            )
        })?;
        let entry = |path: PathBuf| match fcc_record::entry(&path) {
            Ok(entry) => Listed::Entry(entry),
            Err(error) => Listed::Not {
                path,
                error: error.to_string(),
            },
        };
        Ok(files.into_iter().map(entry).collect())
    });
    json::to_python(py, &listed.map_err(|words| errors::RECORDING.with(words))?)
}

/// Makes a whole recording of one that was cut off or damaged, in its place; a
/// whole one is left alone. What came of it is a dict.
#[pyfunction]
pub(crate) fn recover(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let recovered = py
        .detach(|| fcc_record::recover(&path, |_| {}))
        .map_err(|error| errors::RECORDING.with(error))?;
    json::to_python(py, &recovered)
}
