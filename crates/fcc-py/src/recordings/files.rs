//! The daemon's commands for recordings: list, recover, report, replay.

#![expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]

use std::path::PathBuf;

use fcc_core::flight::Autopilot;
use fcc_flight::replay::{recorded_config, recorded_pattern, replay as replay_of};
use fcc_record::{Listed, Recording};
use fcc_replay::{Chain, Deviation, Identity, Replayed};
use fcc_report::{FlightAddition, FlightReport, FlightSurvey};
use pyo3::prelude::*;
use serde::Serialize;

use crate::config::configuration;
use crate::errors;
use crate::json;

/// The recordings in a folder, oldest first, each as a dict. A file that cannot
/// be read has only the keys `path` and `error`.
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
#[pyfunction]
pub(crate) fn recover(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let recovered = py
        .detach(|| fcc_record::recover(&path, |_| {}))
        .map_err(|error| errors::RECORDING.with(error))?;
    json::to_python(py, &recovered)
}

/// Reports on a recording as `fccd report` does: all statistics as a dict.
/// `html` is a page to write with all plots, `svg` a folder for each of them
/// as a file, `csv` a folder for every tick and event as tables.
#[pyfunction]
#[pyo3(signature = (path, *, html = None, svg = None, csv = None))]
pub(crate) fn report(
    py: Python<'_>,
    path: PathBuf,
    html: Option<PathBuf>,
    svg: Option<PathBuf>,
    csv: Option<PathBuf>,
) -> PyResult<Bound<'_, PyAny>> {
    let made = py.detach(|| -> Result<FlightReport, String> {
        let recording = Recording::open(&path).map_err(|error| error.to_string())?;
        let addition = FlightAddition::new(recorded_pattern(recording.about()));
        let report = FlightSurvey::read(&recording, addition, csv.as_deref(), |_| {})?;
        if let Some(folder) = &svg {
            report.write_svgs(folder, &path)?;
        }
        if let Some(html) = &html {
            report.write_page(html, &path)?;
        }
        Ok(report)
    });
    json::to_python(py, &made.map_err(|words| errors::RECORDING.with(words))?)
}

/// Replays a recording with the code that flew it, as `fccd replay` does;
/// returns a dict with `identical`, and the differences. With another `config`
/// the dict contains the deviation of its commands. `paths` is a file, or the parts of a recording, oldest first.
#[pyfunction]
#[pyo3(signature = (paths, config = None))]
pub(crate) fn replay<'py>(
    py: Python<'py>,
    paths: &Bound<'py, PyAny>,
    config: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    #[derive(Serialize)]
    struct Flown {
        #[serde(flatten)]
        replayed: Replayed,
        identical: Option<bool>,
        identity: Option<Identity>,
        deviation: Option<Deviation>,
    }
    let paths: Vec<PathBuf> = match paths.extract::<PathBuf>() {
        Ok(one) => vec![one],
        Err(_) => paths.extract()?,
    };
    let other = config
        .map(|config| configuration(Some(config)))
        .transpose()?;
    let flown = py.detach(|| -> Result<Flown, String> {
        let chain = Chain::open(&paths).map_err(|error| error.to_string())?;
        let recorded = recorded_config(&chain).map_err(|error| error.to_string())?;
        let same = other.is_none();
        let rate_hz = recorded.tick.rate_hz;
        let mut config = other.unwrap_or(recorded);
        // The times of a recording cannot be changed.
        config.tick.rate_hz = rate_hz;
        let replay = replay_of(&config).map_err(|error| format!("the loop's timer: {error}"))?;
        let mut identity = same.then(Identity::of::<Autopilot>);
        let mut deviation = (!same).then(Deviation::of::<Autopilot>);
        let compare = |recorded: &_, again: &_| {
            if let Some(identity) = &mut identity {
                identity.take(recorded, again);
            }
            if let Some(deviation) = &mut deviation {
                deviation.take(recorded, again);
            }
        };
        Ok(Flown {
            replayed: chain.replay(replay, compare, |_| {}),
            identical: identity.as_ref().map(Identity::is_identical),
            identity,
            deviation,
        })
    });
    json::to_python(py, &flown.map_err(|words| errors::RECORDING.with(words))?)
}
