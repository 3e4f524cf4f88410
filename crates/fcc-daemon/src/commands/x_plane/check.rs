//! `fccd x-plane check`: the twenty steps against a running X-Plane.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use fcc_record::{is_same_file, may_be_output};
use fcc_xplane_check::{Report, Request, check as carry_out};

use super::terminal::Terminal;
use super::{Failure, not_begun, request};
use crate::cli::x_plane::XPlaneCheckArgs;
use crate::exit::Exit;
use crate::output;
use crate::process::is_flown;

/// Checks `fccd` against a running X-Plane.
pub(super) fn check(args: &XPlaneCheckArgs) -> Result<Exit, Failure> {
    let files = ReportFiles::of(&args.report, args.connection.config.as_deref())?;
    let (request, config) = request(&args.connection, files.folder.clone())?;
    if !args.yes && !io::stdin().is_terminal() {
        return Err(Failure::usage(
            "fccd: a person is needed, and standard input is no terminal: run it in one, or \
             give --yes against a stand-in for X-Plane",
        ));
    }
    let request = Request {
        report: vec![files.markdown.clone(), files.json.clone()],
        only: args.only.clone(),
        is_unattended: args.yes,
        is_short: args.quick,
        ..request
    };
    let mut terminal = Terminal::open(!args.yes)?;
    let result = carry_out(request, &mut terminal, &|plant| is_flown(&config, plant));
    drop(terminal);
    let report = result.map_err(|error| not_begun(&error))?;
    Ok(finish(&report, &files, args.json))
}

/// Where the report is written, and the files of the flights.
struct ReportFiles {
    markdown: PathBuf,
    json: PathBuf,
    folder: PathBuf,
}

impl ReportFiles {
    /// Beside the report in Markdown, if these are three names and none is that
    /// of the configuration, which would be overwritten.
    fn of(report: &Path, config: Option<&Path>) -> Result<Self, Failure> {
        let files = Self {
            markdown: report.to_owned(),
            json: report.with_extension("json"),
            folder: report.with_extension("files"),
        };
        let wrong = |why: &str| {
            let report = report.display();
            Err(Failure::usage(format_args!(
                "fccd: --report {report}: {why}; give a name such as x-plane-check.md"
            )))
        };
        if files.json == files.markdown || files.folder == files.markdown {
            return wrong(
                "the report in Markdown needs a name of its own, beside the endings .json and \
                 .files",
            );
        }
        let is_config = |file: &Path| config.is_some_and(|config| is_same_file(file, config));
        if is_config(&files.markdown) || is_config(&files.json) {
            return wrong("the report would overwrite the configuration");
        }
        for file in [&files.markdown, &files.json] {
            may_be_output(file).map_err(|error| {
                Failure::usage(format_args!("fccd: --report {}: {error}", file.display()))
            })?;
        }
        Ok(files)
    }
}

/// Writes the report and prints the summary.
fn finish(report: &Report, files: &ReportFiles, json: bool) -> Exit {
    let exit = if report.is_passed() {
        Exit::Success
    } else {
        Exit::StepFailed
    };
    let (file, beside) = (&files.markdown, &files.json);
    let written = serde_json::to_string_pretty(report)
        .map_err(io::Error::other)
        .and_then(|text| fs::write(beside, text + "\n"))
        .and_then(|()| fs::write(file, report.markdown()));
    if let Err(error) = &written {
        output::message(format!("fccd: {}: {error}", file.display()));
    }
    let exit = match written {
        Err(_) if exit == Exit::Success => Exit::Failure,
        _ => exit,
    };
    if json {
        return output::json(report, exit);
    }
    let mut text = report.summary();
    if written.is_ok() {
        let (file, beside) = (file.display(), beside.display());
        let _ = write!(text, "\nreport: {file}, {beside}");
    }
    output::result(text, exit)
}
