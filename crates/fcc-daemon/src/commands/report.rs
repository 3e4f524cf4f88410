//! `fccd report FILE`: what a recording tells.

use std::fs;
use std::path::Path;

use fcc_core::flight::guidance::GuidanceConfig;
use fcc_core::flight::guidance::TimedPatternConfig;
use fcc_record::{Item, Recording};
use fcc_report::{CsvFolder, FileEnd, Origin, Report, Survey};

use super::{fail, progress};
use crate::cli::ReportArgs;
use crate::exit::Exit;
use crate::output;
use fcc_flight::config::Config;

/// Messages between two looks at how far the file is read.
const BAR_EVERY: u64 = 4_096;

/// Reads a recording and reports on it.
pub(super) fn report(args: &ReportArgs) -> Exit {
    let made = read(args).and_then(|report| write_page(args, &report).map(|()| report));
    let report = match made {
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

/// One pass over the file.
fn read(args: &ReportArgs) -> Result<Report, String> {
    if let Some(html) = &args.html
        && is_same_file(html, &args.file)
    {
        return Err(format!(
            "{}: is the recording itself: give the page another name",
            html.display()
        ));
    }
    let recording = Recording::open(&args.file).map_err(|error| error.to_string())?;
    let origin = Origin::of(&recording);
    let mut csv = match &args.csv {
        None => None,
        Some(folder) => Some(
            CsvFolder::<fcc_core::flight::Autopilot>::create(folder, &origin)
                .map_err(|error| format!("{}: cannot be written: {error}", folder.display()))?,
        ),
    };
    let csv_failed = |error| {
        let folder = args.csv.as_deref().unwrap_or(Path::new("")).display();
        format!("{folder}: cannot be written: {error}")
    };
    let mut survey = Survey::new(origin, pattern(&recording));
    let mut items = recording.items().map_err(|error| error.to_string())?;
    let bar = progress::bar(recording.bytes(), "reading");
    let mut taken = 0_u64;
    while let Some(item) = items.next() {
        survey
            .take_item(&item)
            .map_err(|error| format!("{}: {error}", args.file.display()))?;
        if let Some(csv) = &mut csv {
            match &item {
                Item::Message(message) => csv.take(message),
                Item::Remark(remark) => csv.take_remark(remark),
                Item::Damage(damage) => csv.take_remark(&damage.remark()),
            }
            .map_err(csv_failed)?;
        }
        taken += 1;
        if taken.is_multiple_of(BAR_EVERY) {
            bar.set_position(items.bytes_read());
        }
    }
    bar.finish_and_clear();
    if let Some(csv) = csv {
        csv.finish().map_err(csv_failed)?;
    }
    Ok(survey.finish(FileEnd::of(&recording, items.cut())))
}

fn write_page(args: &ReportArgs, report: &Report) -> Result<(), String> {
    if let Some(folder) = &args.svg {
        report.write_svgs(folder)?;
    }
    let Some(path) = &args.html else {
        return Ok(());
    };
    let page = report.to_html().map_err(|error| error.to_string())?;
    fs::write(path, page).map_err(|error| format!("{}: cannot be written: {error}", path.display()))
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}

/// The pattern that was to be flown, by the configuration in the recording; a
/// configuration of another version may not be understood, and then nothing
/// is scored.
fn pattern(recording: &Recording) -> Option<TimedPatternConfig> {
    let config = Config::parse_autopilot(&recording.about().config, "the recording").ok()?;
    match config.guidance {
        GuidanceConfig::TimedPattern(pattern) => Some(pattern),
        GuidanceConfig::Hold => None,
    }
}
