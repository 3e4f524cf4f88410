//! `fccd report FILE`: a report on a recording.

use fcc_fixed_wing::Autopilot;
use fcc_flight::replay::{recorded_pattern, recorded_plan};
use fcc_record::Recording;
use fcc_report::{FlightAddition, Report, Reported, Survey, TABLES};
use fcc_telemetry::FlightMessage;

use super::failure::Failure;
use super::plan_picture::lines;
use super::progress;
use crate::cli::ReportArgs;
use crate::exit::Exit;
use crate::output;

/// Reads a recording and reports on it.
pub(super) fn report(args: &ReportArgs) -> Result<Exit, Failure> {
    let recording = Recording::open_as::<FlightMessage>(&args.file)?;
    let addition = FlightAddition::new(recorded_pattern(recording.about()))
        .with_plan(recorded_plan(recording.about()).map(|(which, plan)| (which, lines(&plan))));
    print::<Autopilot>(args, &recording, addition)
}

/// Reports on the recording of any vehicle.
pub(super) fn print<C: Reported>(
    args: &ReportArgs,
    recording: &Recording,
    addition: C::Addition,
) -> Result<Exit, Failure> {
    let (report, written) = make::<C>(args, recording, addition).map_err(Failure::new)?;
    let exit = if report.is_complete() {
        Exit::Success
    } else {
        Exit::Incomplete
    };
    Ok(if args.json {
        output::json(&report, exit)
    } else {
        let lines: Vec<String> = [report.to_text()].into_iter().chain(written).collect();
        output::result(lines.join("\n"), exit)
    })
}

/// The report, and a line on each file or folder that was written.
fn make<C: Reported>(
    args: &ReportArgs,
    recording: &Recording,
    addition: C::Addition,
) -> Result<(Report<C::Addition>, Vec<String>), String> {
    let bar = progress::bar(recording.bytes(), "reading");
    let report = Survey::<C>::read(recording, addition, args.csv.as_deref(), |read| {
        bar.set_position(read);
    })?;
    bar.finish_and_clear();
    let mut written = Vec::new();
    if let Some(folder) = &args.csv {
        let tables = TABLES.join(", ");
        written.push(format!("written: {}: {tables}", folder.display()));
    }
    if let Some(folder) = &args.svg {
        let plots = report.write_svgs(folder, &args.file)?;
        written.push(format!("written: {}: {plots} plots", folder.display()));
    }
    if let Some(page) = &args.html {
        let tables = args
            .csv
            .iter()
            .flat_map(|folder| TABLES.map(|table| folder.join(table)));
        let others: Vec<_> = tables.chain([args.file.clone()]).collect();
        report.write_page(page, &others)?;
        written.push(format!("written: {}", page.display()));
    }
    Ok((report, written))
}
