//! A command and its answer as one line of text each.
//!
//! ```text
//! engage | disengage | stop | set NAME=VALUE NAME=VALUE ...
//! carried-out TICK | refused WHY
//! ```

use fcc_live::{Command, Verdict};
use fcc_telemetry::units::AVIATION;

/// A command as a line, without its end; none of one that is not for other users: a
/// plan's file would be read with the daemon's rights.
pub(super) fn line_of(command: &Command) -> Option<String> {
    Some(match command {
        Command::Engage => "engage".to_owned(),
        Command::Disengage => "disengage".to_owned(),
        Command::Stop => "stop".to_owned(),
        Command::Set(given) => given.iter().fold("set".to_owned(), |line, (name, value)| {
            line + &format!(" {name}={value}")
        }),
        Command::ReplacePlan { .. } => return None,
    })
}

/// The command of a line.
///
/// # Errors
/// Why it is none. Names and limits of set points are checked later.
pub fn command_of(line: &str) -> Result<Command, &'static str> {
    let mut words = line.split_ascii_whitespace();
    let command = match words.next() {
        Some("engage") => Command::Engage,
        Some("disengage") => Command::Disengage,
        Some("stop") => Command::Stop,
        Some("set") => {
            let given = words.by_ref().map(|word| {
                let (name, value) = word.split_once('=')?;
                Some((name.to_owned(), value.parse().ok()?))
            });
            let given: Option<Vec<_>> = given.collect();
            Command::Set(given.ok_or("a set point is NAME=NUMBER")?)
        }
        _ => return Err("there is no such command: give engage, disengage, stop or set"),
    };
    match words.next() {
        None => Ok(command),
        Some(_) => Err("there is something after the command"),
    }
}

/// An answer as a line with its end.
pub(super) fn line_of_answer(verdict: &Verdict) -> String {
    let why = match verdict {
        Verdict::CarriedOut { tick } => return format!("carried-out {tick}\n"),
        Verdict::Refused(why) => why.clone(),
        Verdict::Outside(outside) => outside.text_in(AVIATION),
    };
    format!("refused {}\n", why.replace('\n', " "))
}

/// The answer of a line; none if it is none.
pub(super) fn answer_of(line: &str) -> Option<Result<u64, String>> {
    let (word, rest) = line.trim_end().split_once(' ')?;
    match word {
        "carried-out" => rest.parse().ok().map(Ok),
        "refused" => Some(Err(rest.to_owned())),
        _ => None,
    }
}

/// The answer of a line, and the line of an answer as its receiver reads it.
#[cfg(fuzzing)]
pub fn answer_as_received(answer: Result<&str, &Verdict>) -> Option<Result<u64, String>> {
    match answer {
        Ok(line) => answer_of(line),
        Err(verdict) => {
            let line = line_of_answer(verdict);
            assert_eq!(line.find('\n'), Some(line.len() - 1));
            answer_of(&line)
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_is_sent_is_received() {
        let set = Command::set([("heading_rad", 0.1 + 0.2), ("altitude_m", -1e300)]);
        for command in [Command::Engage, Command::Disengage, Command::Stop, set] {
            assert_eq!(command_of(&line_of(&command).unwrap()), Ok(command));
        }
        let replacing = Command::ReplacePlan {
            file: "/etc/shadow".to_owned(),
            item: 1,
        };
        assert_eq!(line_of(&replacing), None);
        assert!(command_of("replace-plan /etc/shadow 1").is_err());
        let refused = Verdict::Refused("no\nway".to_owned());
        assert_eq!(
            answer_of(&line_of_answer(&refused)),
            Some(Err("no way".to_owned()))
        );
        let done = Verdict::CarriedOut { tick: 7 };
        assert_eq!(answer_of(&line_of_answer(&done)), Some(Ok(7)));
        for line in ["", "engage now", "set x", "set x=", "fly", "set =1 y"] {
            assert!(command_of(line).is_err() || line == "set =1 y", "{line}");
        }
    }

    proptest! {
        #[test]
        fn any_line_is_handled(line in ".{0,600}") {
            let _ = command_of(&line);
            let _ = answer_of(&line);
        }
    }
}
