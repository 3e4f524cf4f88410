//! `fccd check-controls CONFIG`: each control is moved on the ground, and a person says what it
//! did, or the plant measures it.

use std::fmt::Write as _;
use std::io::{self, IsTerminal};

use fcc_flight::config::{ActuatorEntry, Config};
use fcc_flight::flight::{FlyError, Movement, Unchecked, Verdict, check_controls as carry_out};
use serde_json::json;

use super::answers::answers;
use super::failure::Failure;
use super::fly::assembled;
use super::run::give_up_rights;
use crate::cli::CheckControlsArgs;
use crate::exit::Exit;
use crate::output;
use crate::process::Process;

const KEYS: &str = "y, Enter: yes; o, Enter: it went the other way; n, Enter: it did not move, or \
                    another control did; q, Enter: end";

/// Moves the controls, and prints what they did.
pub(super) fn check_controls(args: &CheckControlsArgs) -> Result<Exit, Failure> {
    let (config, _) = Config::load_with_text(&args.config)?;
    give_up_rights(&config)?;
    let assembly = assembled(&config)?;
    if args.throttle {
        output::message("--throttle moves the throttle to full: is the propeller off?");
    }
    let has_person = io::stdin().is_terminal();
    output::message(if has_person {
        KEYS
    } else {
        "standard input is no terminal: only measured positions are checked"
    });
    let answers = has_person.then(|| {
        answers(|line| match line {
            Some("y") => Some(Some(Verdict::Ok)),
            Some("o") => Some(Some(Verdict::Reversed)),
            Some("n") => Some(Some(Verdict::NoEffect)),
            Some("q") | None => Some(None),
            _ => None,
        })
    });
    let checked = carry_out(
        assembly,
        &config,
        args.throttle,
        &mut Process::new(&config),
        answers.as_ref(),
        &mut |words| output::message(words),
    );
    let movements = checked.movements;
    let exit = match &checked.ended {
        _ if !checked.released => Exit::NotReleased,
        Ok(()) if movements.iter().all(|one| one.verdict == Verdict::Ok) => Exit::Success,
        Ok(()) | Err(Unchecked::Moves(_) | Unchecked::Ended) => Exit::ControlsNotChecked,
        Err(Unchecked::NotBegun(FlyError::Taken(_))) => Exit::Taken,
        Err(Unchecked::NoControls) => Exit::Usage,
        Err(_) => Exit::Failure,
    };
    let error = checked.ended.err().map(|error| error.to_string());
    if let Some(error) = &error {
        output::message(format_args!("fccd: {error}"));
    }
    if movements.iter().any(|one| one.verdict == Verdict::Reversed) {
        output::message(format_args!("fccd: reversed: {}", advice(&config)));
    }
    if args.json {
        let released = checked.released;
        let printed = json!({"movements": movements, "error": error, "released": released});
        return Ok(output::json(&printed, exit));
    }
    if movements.is_empty() {
        return Ok(exit);
    }
    Ok(output::result(table(&movements), exit))
}

/// What to change for a control that is reversed.
fn advice(config: &Config) -> &'static str {
    let mut actuators = config.actuators().iter();
    let moved = actuators.find(|entry| !matches!(entry, ActuatorEntry::Simulator(_)));
    match moved {
        Some(ActuatorEntry::Servos(_)) => "change reversed of each actuator.channel that drives it",
        Some(_) => "change its direction in the servo board's firmware (docs/servo-board.md)",
        None => "the simulator, or a plugin in it, moves it against what is written to it",
    }
}

fn table(movements: &[Movement]) -> String {
    let mut text = format!(
        "{:<12}{:<14}{:<14}{:<11}result",
        "control", "commanded", "read back", "seen"
    );
    for one in movements {
        let [small, full] = one.commanded.map(|to| format!("{to:+.1}"));
        let read = one.read_back.map(|at| at.map(|at| format!("{at:+.2}")));
        let [at_small, at_full] = read.map(|at| at.unwrap_or_else(|| "-".to_owned()));
        let (seen, result) = (one.seen.map_or("-", words), words(one.verdict));
        let (commanded, read) = (format!("{small}, {full}"), format!("{at_small}, {at_full}"));
        let control = one.control;
        let _ = write!(
            text,
            "\n{control:<12}{commanded:<14}{read:<14}{seen:<11}{result}"
        );
    }
    text
}

const fn words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Ok => "ok",
        Verdict::Unconfirmed => "not confirmed",
        Verdict::NoEffect => "NO EFFECT",
        Verdict::Reversed => "REVERSED",
    }
}
