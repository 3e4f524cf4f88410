//! `fccd x-plane check`: the twenty steps against a running X-Plane.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, IsTerminal};
use std::path::Path;

use fcc_xplane_check::{Report, Request, check as carry_out};

use super::terminal::Terminal;
use super::{Failure, not_begun, request};
use crate::cli::x_plane::XPlaneCheckArgs;
use crate::exit::Exit;
use crate::output;

/// Checks `fccd` against a running X-Plane.
pub(super) fn check(args: &XPlaneCheckArgs) -> Result<Exit, Failure> {
    let request = request(&args.connection, args.report.with_extension("files"))?;
    if !args.yes && !io::stdin().is_terminal() {
        return Err(Failure::usage(
            "fccd: a person is needed, and standard input is no terminal: run it in one, or \
             give --yes against a stand-in for X-Plane",
        ));
    }
    let request = Request {
        only: args.only.clone(),
        is_unattended: args.yes,
        is_short: args.quick,
        ..request
    };
    let mut terminal = Terminal::open(!args.yes)?;
    let result = carry_out(request, &mut terminal);
    drop(terminal);
    let report = result.map_err(|error| not_begun(&error))?;
    Ok(finish(&report, &args.report, args.json))
}

/// Writes the report and prints the summary.
fn finish(report: &Report, file: &Path, json: bool) -> Exit {
    let exit = if report.is_passed() {
        Exit::Success
    } else {
        Exit::StepFailed
    };
    let beside = file.with_extension("json");
    let written = serde_json::to_string_pretty(report)
        .map_err(io::Error::other)
        .and_then(|text| fs::write(&beside, text + "\n"))
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
