//! `fccd report FILE`: a report on a recording.

use fcc_core::flight::guidance::GuidanceConfig;
use fcc_core::flight::guidance::TimedPatternConfig;
use fcc_record::{OpenError, Recording};
use fcc_report::{FlightAddition, FlightReport, FlightSurvey};

use super::{fail, progress};
use crate::cli::ReportArgs;
use crate::exit::Exit;
use crate::output;
use fcc_flight::config::Config;
use fcc_telemetry::FlightMessage;

/// Reads a recording and reports on it.
pub(super) fn report(args: &ReportArgs) -> Exit {
    let recording = match Recording::open_as::<FlightMessage>(&args.file) {
        Ok(recording) => recording,
        Err(error) => {
            fail(&error.to_string());
            return match error {
                OpenError::AnotherPlant { .. } => Exit::Usage,
                _ => Exit::Failure,
            };
        }
    };
    let report = match make(args, &recording) {
        Ok(report) => report,
        Err(message) => return fail(&message),
    };
    let exit = if report.is_complete() || fcc_record::is_being_written(&args.file) {
        Exit::Success
    } else {
        Exit::Incomplete
    };
    if args.json {
        output::json(&report, exit)
    } else {
        output::result(report.to_text(), exit)
    }
}

fn make(args: &ReportArgs, recording: &Recording) -> Result<FlightReport, String> {
    let bar = progress::bar(recording.bytes(), "reading");
    let addition = FlightAddition::new(pattern(recording));
    let report = FlightSurvey::read(recording, addition, args.csv.as_deref(), |read| {
        bar.set_position(read);
    })?;
    bar.finish_and_clear();
    if let Some(folder) = &args.svg {
        report.write_svgs(folder, &args.file)?;
    }
    if let Some(page) = &args.html {
        report.write_page(page, &args.file)?;
    }
    Ok(report)
}

/// The pattern in the recorded configuration; a configuration of another
/// version may be invalid, and then nothing is scored.
fn pattern(recording: &Recording) -> Option<TimedPatternConfig> {
    let config = Config::parse_autopilot(&recording.about().config, "the recording").ok()?;
    match config.guidance {
        GuidanceConfig::TimedPattern(pattern) => Some(pattern),
        GuidanceConfig::Hold => None,
    }
}
