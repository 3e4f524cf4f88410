//! `fccd check FILE`.

use std::fmt::Write as _;
use std::path::Path;

use serde::Serialize;

use crate::cli::CheckArgs;
use crate::exit::Exit;
use crate::output;
use crate::process::{commanders_refused, unknown_names};
use fcc_flight::config::{Aircraft, Config, Problem};

#[derive(Serialize)]
struct Checked {
    file: String,
    ok: bool,
    problems: Vec<Problem>,
    /// Notes, for example on a default that matters.
    remarks: Vec<String>,
}

/// Checks a configuration file.
pub(super) fn check(args: &CheckArgs) -> Exit {
    let (checked, remarks) = match Config::load_with_text(&args.file) {
        Ok((config, text)) => {
            let mut remarks = config.remarks(&text);
            remarks.extend(unknown_names(&config.rights));
            remarks.extend(commanders_refused(&config.rights, Path::new("/")));
            (Ok(config), remarks)
        }
        Err(error) => (Err(error), Vec::new()),
    };
    let exit = if checked.is_ok() {
        Exit::Success
    } else {
        Exit::Usage
    };
    if args.json {
        let problems = match &checked {
            Ok(_) => Vec::new(),
            Err(error) => error.problems(),
        };
        let checked = Checked {
            file: args.file.display().to_string(),
            ok: checked.is_ok(),
            problems,
            remarks,
        };
        return output::json(&checked, exit);
    }
    match checked {
        Ok(config) => {
            let aircraft = match config.aircraft() {
                Some(Aircraft::XPlane(_)) => "X-Plane's aircraft",
                Some(Aircraft::BuiltIn(_)) => "the built-in aircraft",
                None => "by the listed sensors and actuators",
            };
            let mut text = format!(
                "{}: valid: flies {aircraft} at {} Hz by {}",
                args.file.display(),
                config.tick.rate_hz,
                config.tick.timer
            );
            for remark in remarks {
                let _ = write!(text, "\n{}: {remark}", args.file.display());
            }
            output::result(text, exit)
        }
        Err(error) => {
            output::message(error);
            exit
        }
    }
}
