//! A report on a recording, as `fccd report --json` prints it.

use std::path::Path;

use fcc_flight::replay::recorded_pattern;
use fcc_record::Recording;
use fcc_report::{FlightAddition, FlightSurvey};
use fcc_telemetry::FlightMessage;

use crate::failure::Failure;

/// Reads the whole file, and reports on it, as JSON.
///
/// # Errors
/// When it is no recording of a flight, or cannot be read.
pub(crate) fn of(file: &Path) -> Result<String, Failure> {
    let wrong = |error: &dyn std::fmt::Display| Failure::Recording(error.to_string());
    let recording = Recording::open_as::<FlightMessage>(file).map_err(|error| wrong(&error))?;
    let addition = FlightAddition::new(recorded_pattern(recording.about()));
    let report = FlightSurvey::read(&recording, addition, None, |_| {});
    serde_json::to_string(&report.map_err(|error| wrong(&error))?).map_err(|error| wrong(&error))
}
