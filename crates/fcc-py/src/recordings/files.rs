//! What the daemon's commands do with recordings: list, recover, report,
//! replay.

#![expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]

use std::path::PathBuf;

use fcc_core::flight::Autopilot;
use fcc_core::flight::guidance::GuidanceConfig;
use fcc_core::flight::guidance::TimedPatternConfig;
use fcc_flight::config::Config;
use fcc_flight::replay::{recorded_config, replay as replay_of};
use fcc_record::Recording;
use fcc_replay::{Chain, Deviation, Identity, Replayed};
use fcc_report::{FlightAddition, FlightReport, FlightSurvey};
use pyo3::prelude::*;
use serde::Serialize;

use crate::config::configuration;
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
        let addition = FlightAddition::new(pattern(&recording));
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

/// The pattern that was to be flown; a configuration of another version may
/// not be understood, and then nothing is scored.
fn pattern(recording: &Recording) -> Option<TimedPatternConfig> {
    let config = Config::parse_autopilot(&recording.about().config, "the recording").ok()?;
    match config.guidance {
        GuidanceConfig::TimedPattern(pattern) => Some(pattern),
        GuidanceConfig::Hold => None,
    }
}

/// Flies a recording again through the very code that flew it, as
/// `fccd replay` does: a dict with `identical`, and where it is not. With
/// another `config` the dict says where that one would have commanded
/// otherwise. `paths` is a file, or the parts of a recording, oldest first.
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
