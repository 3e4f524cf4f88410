//! What the program prints: results on standard output, messages for people on
//! standard error.
//!
//! Everything that is printed goes through here, for `print!` and `eprint!`
//! panic when the output cannot be written: a pipe whose reader has left, a
//! full disk, a terminal that is gone. Here a result that cannot be printed is
//! an exit code, and a message that cannot be printed is dropped.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::exit::Exit;

/// Prints a result. Gives `exit`, or a failure where that was a success and the
/// result could not be printed. A reader that has left (`| head -1`) has all
/// that it wanted.
pub(crate) fn result(text: impl Display, exit: Exit) -> Exit {
    bytes(format!("{text}\n").as_bytes(), exit)
}

/// Prints a result for other tools to read, in the same way.
pub(crate) fn json<T: Serialize>(value: &T, exit: Exit) -> Exit {
    match serde_json::to_string_pretty(value) {
        Ok(text) => result(text, exit),
        Err(error) => not_printed(&error, exit),
    }
}

/// Prints a result as it is, in the same way.
pub(crate) fn bytes(bytes: &[u8], exit: Exit) -> Exit {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => not_printed(&error, exit),
        _ => exit,
    }
}

fn not_printed(error: &dyn Display, exit: Exit) -> Exit {
    message(format!("fccd: the result could not be printed: {error}"));
    match exit {
        Exit::Success => Exit::Failure,
        other => other,
    }
}

/// Prints a message for people.
pub(crate) fn message(text: impl Display) {
    let line = format!("{text}\n");
    match background().as_mut() {
        Some(lines) => lines.give(line),
        None => write(&line),
    }
}

fn write(line: &str) {
    // Nobody is left who could be told.
    let _ = io::stderr().write_all(line.as_bytes());
}

/// Messages that may wait while the terminal does not take them: some minutes
/// of status.
const WAITING: usize = 256;
/// How long the end of a flight waits until they are printed.
const PATIENCE: Duration = Duration::from_secs(1);

static BACKGROUND: Mutex<Option<Lines>> = Mutex::new(None);

fn background() -> MutexGuard<'static, Option<Lines>> {
    BACKGROUND.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From here on a thread of its own prints messages, so that a terminal that is
/// held keeps nobody waiting: what finds no room is left out, and that is
/// printed where there is room again. Until what this gives is dropped.
pub(crate) fn in_background() -> Option<Background> {
    let (to, from) = sync_channel::<String>(WAITING);
    // Without a thread, whoever prints waits for the terminal.
    let printer = thread::Builder::new()
        .name("fccd-printer".to_owned())
        // Where memory is locked, all of a stack is in memory.
        .stack_size(256 << 10)
        .spawn(move || from.iter().for_each(|line| write(&line)))
        .ok()?;
    *background() = Some(Lines { to, left_out: 0 });
    Some(Background { printer })
}

/// Messages on their way to the thread that prints them.
struct Lines {
    to: SyncSender<String>,
    left_out: u64,
}

impl Lines {
    fn give(&mut self, line: String) {
        if self.left_out > 0 {
            let gap = format!(
                "{} lines are left out here: the terminal did not take them\n",
                self.left_out
            );
            if self.to.try_send(gap).is_err() {
                self.left_out += 1;
                return;
            }
            self.left_out = 0;
        }
        if self.to.try_send(line).is_err() {
            self.left_out += 1;
        }
    }
}

/// The thread that prints messages.
pub(crate) struct Background {
    printer: JoinHandle<()>,
}

impl Drop for Background {
    /// Waits for a while until all are printed.
    fn drop(&mut self) {
        // With its last sender the thread ends.
        *background() = None;
        let begun = Instant::now();
        while !self.printer.is_finished() && begun.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_find_no_room_are_counted_where_they_are_missing() {
        let (to, from) = sync_channel(2);
        let mut lines = Lines { to, left_out: 0 };
        for line in ["a", "b", "c", "d"] {
            lines.give(line.to_owned());
        }
        let printed: Vec<String> = from.try_iter().collect();
        assert_eq!(printed, ["a", "b"]);
        lines.give("e".to_owned());
        let printed: Vec<String> = from.try_iter().collect();
        assert_eq!(
            printed,
            [
                "2 lines are left out here: the terminal did not take them\n",
                "e"
            ]
        );
    }
}
