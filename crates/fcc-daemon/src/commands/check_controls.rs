//! `fccd check-controls CONFIG`: each control is moved on the ground, and a person says what it
//! did, or the plant measures it.

use std::fmt::Write as _;
use std::io::{self, IsTerminal};
use std::sync::mpsc::Receiver;

use fcc_flight::config::{ActuatorEntry, Config};
use fcc_flight::flight::{
    Checked, Movement, Onlooker, Reply, Seen, Unchecked, Verdict, check_controls as carry_out,
};
use serde::Serialize;

use super::answers::answers;
use super::failure::Failure;
use super::fly::assembled;
use super::run::give_up_rights;
use crate::cli::CheckControlsArgs;
use crate::exit::Exit;
use crate::output;
use crate::process::Process;

const KEYS: &str = "y, Enter: yes; o, Enter: it went the other way; n, Enter: it did not move, or \
                    another control did; q, Enter: end.";

/// Moves the controls, and prints what they did.
pub(super) fn check_controls(args: &CheckControlsArgs) -> Result<Exit, Failure> {
    let (config, _) = Config::load_with_text(&args.config)?;
    give_up_rights(&config)?;
    let assembly = assembled(&config)?;
    if args.throttle {
        output::message("--throttle moves the throttle to full: is the propeller off?");
    }
    let mut terminal = io::stdin().is_terminal().then(Terminal::open);
    if terminal.is_none() {
        output::message("standard input is no terminal: only measured positions are checked");
    }
    let checked = carry_out(
        assembly,
        &config,
        args.throttle,
        &mut Process::new(&config),
        terminal
            .as_mut()
            .map(|terminal| terminal as &mut dyn Onlooker),
        &mut |words| output::message(format_args!("fccd: {words}")),
    );
    Ok(finish(&config, &checked, args.json))
}

/// The person at the terminal.
struct Terminal(Receiver<Option<Reply>>);

impl Terminal {
    fn open() -> Self {
        output::message(KEYS);
        Self(answers(|line| match line {
            Some("y") => Some(Reply::Seen(Seen::Yes)),
            Some("o") => Some(Reply::Seen(Seen::OtherWay)),
            Some("n") => Some(Reply::Seen(Seen::No)),
            Some("q") | None => Some(Reply::Quit),
            _ => None,
        }))
    }
}

impl Onlooker for Terminal {
    fn ask(&mut self, question: &str) {
        // An answer given before the question is none.
        self.0.try_iter().for_each(drop);
        output::message(format_args!("{question} [y/o/n/q]"));
    }

    fn reply(&mut self) -> Option<Reply> {
        let reply = self.0.try_recv().ok()?;
        if reply.is_none() {
            output::message(KEYS);
        }
        reply
    }
}

/// What is printed with `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    movements: &'a [Movement],
    /// Why not all controls were moved.
    error: Option<String>,
    released: bool,
}

fn finish(config: &Config, checked: &Checked, json: bool) -> Exit {
    let movements = &checked.movements;
    let is_ok = movements.iter().all(|one| one.verdict == Verdict::Ok);
    let exit = match &checked.ended {
        _ if !checked.released => Exit::NotReleased,
        Ok(()) if is_ok => Exit::Success,
        Ok(()) | Err(Unchecked::Moves { .. } | Unchecked::Ended) => Exit::ControlsNotChecked,
        Err(Unchecked::Taken(_)) => Exit::Taken,
        Err(Unchecked::NoControls) => Exit::Usage,
        Err(_) => Exit::Failure,
    };
    let error = checked.ended.as_ref().err().map(ToString::to_string);
    if let Some(error) = &error {
        output::message(format_args!("fccd: {error}"));
    }
    let is_reversed = |one: &Movement| one.verdict == Verdict::Reversed;
    if movements.iter().any(is_reversed) {
        output::message(format_args!("fccd: reversed: {}", advice(config)));
    }
    if json {
        let released = checked.released;
        let printed = Printed {
            movements,
            error,
            released,
        };
        return output::json(&printed, exit);
    }
    output::result(table(movements), exit)
}

/// What to change for a control that is reversed.
fn advice(config: &Config) -> &'static str {
    let servos = |entry: &ActuatorEntry| matches!(entry, ActuatorEntry::Servos(_));
    let board = |entry: &ActuatorEntry| matches!(entry, ActuatorEntry::ServoBoard(_));
    if config.actuators().iter().any(servos) {
        "change reversed of each actuator.channel that drives it"
    } else if config.actuators().iter().any(board) {
        "change its direction in the firmware of the servo board (docs/servo-board.md)"
    } else {
        "the simulator, or a plugin in it, moves the control against what is written to it"
    }
}

fn table(movements: &[Movement]) -> String {
    let row = |cells: [&str; 5]| {
        let [control, commanded, read_back, seen, result] = cells;
        format!("{control:<12}{commanded:<14}{read_back:<14}{seen:<14}{result}")
    };
    let mut text = row(["control", "commanded", "read back", "seen", "result"]);
    for one in movements {
        let [small, full] = one.commanded;
        let commanded = format!("{small:+.1}, {full:+.1}");
        let read = one.read_back;
        let read = read.map(|at| at.map_or("-".to_owned(), |at| format!("{at:+.2}")));
        let seen = match one.seen {
            Some(Seen::Yes) => "yes",
            Some(Seen::OtherWay) => "other way",
            Some(Seen::No) => "no",
            None => "-",
        };
        let result = match one.verdict {
            Verdict::Ok => "ok",
            Verdict::Unconfirmed => "not confirmed",
            Verdict::NoEffect => "NO EFFECT",
            Verdict::Reversed => "REVERSED",
        };
        let cells = [one.control, &commanded, &read.join(", "), seen, result];
        let _ = write!(text, "\n{}", row(cells).trim_end());
    }
    text
}
