//! What the program prints: results on standard output, messages for people on
//! standard error.
//!
//! Everything that is printed goes through here, for `print!` and `eprint!`
//! panic when the output cannot be written: a pipe whose reader has left, a
//! full disk, a terminal that is gone. Here a result that cannot be printed is
//! an exit code, and a message that cannot be printed is dropped.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fcc_flight::flight::Lines;
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
    // Nobody is left who could be told.
    let _ = io::stderr().write_all(format!("{text}\n").as_bytes());
}

/// Lines that may wait while the terminal does not take them: some minutes of
/// status.
const WAITING: usize = 256;
/// How long the end of a flight waits until they are printed.
const PATIENCE: Duration = Duration::from_secs(1);

/// Where the lines of a flight in real time go: messages that another thread
/// prints, so that a terminal that is held keeps nobody waiting. What finds no
/// room is left out, and that is printed when there is room again.
pub(crate) fn lines() -> (Lines, Option<Printer>) {
    let (to, from) = sync_channel(WAITING);
    let printing = thread::Builder::new()
        .name("fccd-lines".to_owned())
        .spawn(move || print(&from));
    match printing {
        Ok(thread) => {
            let mut lines = Waiting { to, left_out: 0 };
            let give = move |line| lines.give(line);
            (Box::new(give), Some(Printer { thread }))
        }
        // Without a thread, the flight waits for its terminal.
        Err(_) => (Box::new(message), None),
    }
}

fn print(from: &Receiver<String>) {
    for line in from {
        message(line);
    }
}

/// Lines on their way to the thread that prints them.
struct Waiting {
    to: SyncSender<String>,
    left_out: u64,
}

impl Waiting {
    fn give(&mut self, line: String) {
        if self.left_out > 0 {
            let gap = format!(
                "{} lines are left out here: the terminal did not take them",
                self.left_out
            );
            if self.to.try_send(gap).is_err() {
                self.left_out += 1;
                return;
            }
            self.left_out = 0;
        }
        if let Err(TrySendError::Full(_)) = self.to.try_send(line) {
            self.left_out += 1;
        }
    }
}

/// The thread that prints lines. It ends when nobody gives any more.
pub(crate) struct Printer {
    thread: JoinHandle<()>,
}

impl Printer {
    /// Waits for a while until all are printed.
    pub(crate) fn finish(self) {
        let begun = Instant::now();
        while !self.thread.is_finished() && begun.elapsed() < PATIENCE {
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
        let mut lines = Waiting { to, left_out: 0 };
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
                "2 lines are left out here: the terminal did not take them",
                "e"
            ]
        );
    }
}
