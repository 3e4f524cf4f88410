//! `fccd check FILE`.

use serde::Serialize;

use crate::cli::CheckArgs;
use crate::exit::Exit;
use crate::output;
use fcc_flight::config::{Aircraft, Config, Problem};

#[derive(Serialize)]
struct Checked {
    file: String,
    ok: bool,
    problems: Vec<Problem>,
}

/// Checks a configuration file.
pub(super) fn check(args: &CheckArgs) -> Exit {
    let checked = Config::load(&args.file);
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
        };
        return output::json(&checked, exit);
    }
    match checked {
        Ok(config) => {
            let aircraft = match config.aircraft() {
                Aircraft::XPlane(_) => "X-Plane's aircraft",
                Aircraft::BuiltIn(_) => "the built-in aircraft",
            };
            let words = format!(
                "{}: good: flies {aircraft} at {} Hz by {}",
                args.file.display(),
                config.tick.rate_hz,
                config.tick.timer
            );
            output::result(words, exit)
        }
        Err(error) => {
            output::message(error);
            exit
        }
    }
}
