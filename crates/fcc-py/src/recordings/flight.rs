//! The daemon's commands for recordings of flights: report, replay.

#![expect(clippy::needless_pass_by_value, reason = "pyo3 passes paths by value")]

use std::path::PathBuf;

use fcc_flight::replay::{recorded_config, recorded_pattern, replay as replay_of};
use fcc_record::Recording;
use fcc_report::{FlightAddition, FlightReport, FlightSurvey};
use pyo3::prelude::*;

use crate::config::configuration;
use crate::errors;
use crate::json;

/// Reports on a recording as `fccd report` does: all statistics as a dict.
/// `html` is a page to write with all plots, `svg` a folder for each of them
/// as a file, `csv` a folder for every tick and event as tables.
///
/// >>> fcc.report("recordings/flight.mcap")["damages"]
/// []
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
            report.write_page(html, &[&path])?;
        }
        Ok(report)
    });
    json::to_python(py, &made.map_err(|words| errors::RECORDING.with(words))?)
}

/// Replays a recording with the code that flew it, as `fccd replay` does;
/// returns a dict with `identical`, and the differences. With another `config`
/// the dict contains the deviation of its commands. `paths` is a file, or the parts of a recording, oldest first.
///
/// >>> fcc.replay("recordings/flight.mcap")["identical"]
/// True
#[pyfunction]
#[pyo3(signature = (paths, config = None))]
pub(crate) fn replay<'py>(
    paths: &Bound<'py, PyAny>,
    config: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let other = config
        .map(|config| configuration(Some(config)))
        .transpose()?;
    let is_same = other.is_none();
    super::replay(paths, is_same, |chain| {
        let recorded = recorded_config(chain).map_err(|error| error.to_string())?;
        let rate_hz = recorded.tick.rate_hz;
        let mut config = other.unwrap_or(recorded);
        // The times of a recording cannot be changed.
        config.tick.rate_hz = rate_hz;
        replay_of(&config).map_err(|error| format!("the loop's timer: {error}"))
    })
}
