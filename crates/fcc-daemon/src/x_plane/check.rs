//! `fccd x-plane check`: the twenty steps against a running X-Plane.

use std::env;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, ErrorKind, IsTerminal};
use std::path::Path;

use fcc_flight::config::{Config, XPlaneSection};
use fcc_xplane_check::{CheckError, Report, Request, STEPS, check as carry_out};

use super::XPlaneCheckArgs;
use super::terminal::Terminal;
use crate::exit::Exit;
use crate::output;

/// The configuration if none is given: X-Plane on this machine.
const DEFAULT: &str = "[x-plane]\n";

/// Checks `fccd` against a running X-Plane.
pub(super) fn check(args: &XPlaneCheckArgs) -> Exit {
    if args.list {
        return list(args.json);
    }
    let (config, x_plane) = match configuration(args.config.as_deref()) {
        Ok(configured) => configured,
        Err(message) => {
            output::message(message);
            return Exit::Usage;
        }
    };
    if !args.yes && !io::stdin().is_terminal() {
        output::message(
            "fccd: a person is needed, and standard input is no terminal: run it in one, or \
             give --yes against a stand-in for X-Plane",
        );
        return Exit::Usage;
    }
    let program = match env::current_exe() {
        Ok(program) => program,
        Err(error) => return fail(&format!("its own program cannot be found: {error}")),
    };
    let request = Request {
        program,
        config,
        x_plane: (&x_plane).into(),
        folder: args.report.with_extension("files"),
        only: args.only.clone(),
        is_unattended: args.yes,
        is_short: args.quick,
        local_port: args.local_port,
    };
    let mut terminal = match Terminal::open(!args.yes) {
        Ok(terminal) => terminal,
        Err(error) => return fail(&format!("signals cannot be caught: {error}")),
    };
    let result = carry_out(request, &mut terminal);
    drop(terminal);
    match result {
        Ok(report) => finish(&report, &args.report, args.json),
        Err(error) => {
            let taken = matches!(&error, CheckError::Io { source, .. }
                if source.kind() == ErrorKind::AddrInUse);
            fail(&error.to_string());
            if taken { Exit::Taken } else { Exit::Failure }
        }
    }
}

/// The text of the configuration, and where it says that X-Plane is.
fn configuration(file: Option<&Path>) -> Result<(String, XPlaneSection), String> {
    let (config, text) = match file {
        Some(file) => Config::load_with_text(file).map_err(|error| error.to_string())?,
        None => {
            let config = Config::parse(DEFAULT, "the default");
            (
                config.map_err(|error| error.to_string())?,
                DEFAULT.to_owned(),
            )
        }
    };
    let section = config.x_plane.ok_or(
        "fccd x-plane is for X-Plane: give a file with a section [x-plane], such as \
         config/x-plane.toml",
    )?;
    Ok((text, section))
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
        fail(&format!("{}: {error}", file.display()));
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

/// Prints the steps.
fn list(json: bool) -> Exit {
    if json {
        let steps: Vec<_> = STEPS
            .iter()
            .map(|step| {
                serde_json::json!({
                    "number": step.number,
                    "title": step.title,
                    "action": step.action,
                    "passes": step.passes,
                    "source": step.source,
                    "advice": step.advice,
                })
            })
            .collect();
        return output::json(&steps, Exit::Success);
    }
    let mut text = String::new();
    for step in &STEPS {
        let _ = write!(
            text,
            "{:2}. {}\n    {}\n    Passes: {}\n    Limits: {}.\n\n",
            step.number, step.title, step.action, step.passes, step.source
        );
    }
    output::result(text.trim_end(), Exit::Success)
}

fn fail(message: &str) -> Exit {
    output::message(format!("fccd: {message}"));
    Exit::Failure
}
