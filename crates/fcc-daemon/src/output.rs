//! What the program prints: results on standard output, messages for people on
//! standard error.
//!
//! Everything that is printed goes through here, for `print!` and `eprint!`
//! panic when the output cannot be written: a pipe whose reader has left, a
//! full disk, a terminal that is gone. Here a result that cannot be printed is
//! an exit code, and a message that cannot be printed is dropped.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

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
