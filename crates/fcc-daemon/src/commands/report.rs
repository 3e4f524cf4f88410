//! `fccd report FILE`: a report on a recording.

use fcc_flight::replay::recorded_pattern;
use fcc_record::{OpenError, Recording};
use fcc_report::{FlightAddition, FlightReport, FlightSurvey};
use fcc_telemetry::FlightMessage;

use super::failure::Failure;
use super::progress;
use crate::cli::ReportArgs;
use crate::exit::Exit;
use crate::output;

/// Reads a recording and reports on it.
pub(super) fn report(args: &ReportArgs) -> Result<Exit, Failure> {
    let recording = Recording::open_as::<FlightMessage>(&args.file).map_err(|error| {
        let exit = match error {
            OpenError::AnotherPlant { .. } => Exit::Usage,
            _ => Exit::Failure,
        };
        Failure::of(exit, error)
    })?;
    let report = make(args, &recording).map_err(Failure::new)?;
    let exit = if report.is_complete() || fcc_record::is_being_written(&args.file) {
        Exit::Success
    } else {
        Exit::Incomplete
    };
    Ok(if args.json {
        output::json(&report, exit)
    } else {
        output::result(report.to_text(), exit)
    })
}

fn make(args: &ReportArgs, recording: &Recording) -> Result<FlightReport, String> {
    let bar = progress::bar(recording.bytes(), "reading");
    let addition = FlightAddition::new(recorded_pattern(recording.about()));
    let report = FlightSurvey::read(recording, addition, args.csv.as_deref(), |read| {
        bar.set_position(read);
    })?;
    bar.finish_and_clear();
    if let Some(folder) = &args.svg {
        report.write_svgs(folder, &args.file)?;
    }
    if let Some(page) = &args.html {
        let tables = args
            .csv
            .iter()
            .flat_map(|folder| fcc_report::TABLES.map(|table| folder.join(table)));
        let others: Vec<_> = tables.chain([args.file.clone()]).collect();
        report.write_page(page, &others)?;
    }
    Ok(report)
}
