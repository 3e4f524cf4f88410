//! `fccd check FILE...`.

use std::fmt::Write as _;
use std::path::Path;

use serde::Serialize;

use super::calibrate::unix_s;
use super::vehicles::Kind;
use crate::cli::CheckArgs;
use crate::exit::Exit;
use crate::output;
use crate::process::unknown_names;
use fcc_flight::calibrate::{CalibrationFileError, apply, not_calibrated};
use fcc_flight::config::{Aircraft, Config, ConfigError, CpuChoice, Problem};
use fcc_timer::realtime::cpus::Cpus;

#[derive(Serialize)]
struct Checked {
    file: String,
    ok: bool,
    problems: Vec<Problem>,
    /// Notes, for example on a default that matters.
    remarks: Vec<String>,
}

/// Checks configuration files: the exit code is that of the worst.
pub(super) fn check(args: &CheckArgs) -> Exit {
    let mut all = Vec::new();
    let mut exit = Exit::Success;
    for file in &args.files {
        let (checked, description) = check_file(file);
        if !checked.ok {
            exit = Exit::Usage;
        }
        if !args.json {
            match description {
                Ok(text) => exit = output::result(text, exit),
                Err(error) => output::message(error),
            }
        }
        all.push(checked);
    }
    match all.as_slice() {
        _ if !args.json => exit,
        [one] => output::json(one, exit),
        several => output::json(&several, exit),
    }
}

/// Checks a file, and the plan and the calibration that a flight by it uses, and describes
/// it.
fn check_file(path: &Path) -> (Checked, Result<String, ConfigError>) {
    let file = path.display().to_string();
    let text = Config::read_text(path).unwrap_or_default();
    if let Some(kind) = Kind::of_text(&text) {
        let found = (kind.check)(&text, &file);
        let found = found.map(|flies| format!("{file}: valid: {flies}"));
        let checked = Checked {
            file,
            ok: found.is_ok(),
            problems: found
                .as_ref()
                .err()
                .map_or_else(Vec::new, ConfigError::problems),
            remarks: Vec::new(),
        };
        return (checked, found);
    }
    let loaded = Config::load_with_text(path)
        .and_then(|(config, text)| Ok((config.with_plan(&file)?, text)))
        .and_then(|(mut config, text)| {
            let applied = apply(&mut config, unix_s())
                .map_err(|(of, error)| unusable_calibration(&file, &of, &error))?;
            Ok((config, text, applied.remarks))
        });
    match loaded {
        Ok((config, text, calibrated)) => {
            let mut remarks = config.remarks(&text);
            remarks.extend(calibrated);
            remarks.extend(not_calibrated(&config));
            remarks.extend(unknown_names(&config.rights));
            remarks.extend(missing_cpu(&config));
            let aircraft = match config.aircraft() {
                Some(Aircraft::XPlane(_)) => "X-Plane's aircraft",
                Some(Aircraft::BuiltIn(_)) => "the built-in aircraft",
                None => "by the listed sensors and actuators",
            };
            let mut text = format!(
                "{file}: valid: flies {aircraft} at {} Hz by {}",
                config.tick.rate_hz, config.tick.timer
            );
            for remark in &remarks {
                let _ = write!(text, "\n{file}: remark: {remark}");
            }
            let checked = Checked {
                file,
                ok: true,
                problems: Vec::new(),
                remarks,
            };
            (checked, Ok(text))
        }
        Err(error) => {
            let checked = Checked {
                file,
                ok: false,
                problems: error.problems(),
                remarks: Vec::new(),
            };
            (checked, Err(error))
        }
    }
}

/// That this machine lacks the CPU of the loop; the configuration may be another's.
fn missing_cpu(config: &Config) -> Option<String> {
    let online = Cpus::read(Path::new("/")).online;
    let last = online.last()?;
    match config.realtime.cpu? {
        CpuChoice::Number(cpu) if !online.contains(&cpu) => Some(format!(
            "realtime.cpu is {cpu}, and the last CPU of this machine is {last}: here the kernel \
             refuses it; choose \"auto\" or one that exists"
        )),
        _ => None,
    }
}

fn unusable_calibration(file: &str, of: &Path, error: &CalibrationFileError) -> ConfigError {
    ConfigError::Invalid {
        file: file.to_owned(),
        problems: vec![Problem {
            line: None,
            key: Some("calibration.file".to_owned()),
            message: format!("{}: {error}", of.display()),
        }],
    }
}
