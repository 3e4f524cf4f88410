//! Prints results on standard output and messages on standard error.
//!
//! Everything is printed through here, because `print!` and `eprint!` panic
//! when the output cannot be written: a pipe whose reader has left, a full
//! disk, a closed terminal. Here a result that cannot be printed gives an exit
//! code, and a message that cannot be printed is dropped. While a flight is flown in real
//! time, [`Printer`] keeps it from waiting for its output.

mod printer;

use std::fmt::Display;
use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::os::fd::AsFd as _;
use std::os::unix::fs::FileTypeExt as _;

use fcc_telemetry::{printable, printable_json};
use nix::errno::Errno;
use serde::Serialize;

use crate::exit::Exit;
use crate::process::standard_output;
pub(crate) use printer::{Printer, wait_until_printed};

/// Prints a result. Returns `exit`, or a failure if that was a success and the
/// result could not be printed. A reader that has left (`| head -1`, or a closed
/// terminal), or that no longer reads at the end of a flight, is no failure.
pub(crate) fn result(text: impl Display, exit: Exit) -> Exit {
    bytes(line(text).as_bytes(), exit)
}

/// Prints a result as JSON.
pub(crate) fn json<T: Serialize>(value: &T, exit: Exit) -> Exit {
    match serde_json::to_string_pretty(value) {
        Ok(text) => bytes(with_end(printable_json(&text)).as_bytes(), exit),
        Err(error) => not_printed(&error, exit),
    }
}

/// Prints a result as bytes.
pub(crate) fn bytes(bytes: &[u8], exit: Exit) -> Exit {
    let bytes = bytes.to_vec();
    match printer::in_time(move || StandardOutput.write_all(&bytes)) {
        Some(printing) => printed(printing, exit),
        // As a reader that has left.
        None => exit,
    }
}

/// Standard output without what [`io::Stdout`] does: it takes an output that is not
/// open for writing (EBADF) for one that was written.
struct StandardOutput;

impl Write for StandardOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(nix::unistd::write(io::stdout(), bytes)?)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The exit code after printing a result.
pub(crate) fn printed(printing: io::Result<()>, exit: Exit) -> Exit {
    let closed = standard_output::was_closed().then(|| io::Error::from(Errno::EBADF));
    match closed.map_or(printing, Err) {
        Err(error) if !has_left(&error) => not_printed(&error, exit),
        _ => exit,
    }
}

/// Whether nobody reads the output any more: the other end of the pipe was
/// closed, or the terminal was (EIO of a device, and not of a disk).
fn has_left(error: &io::Error) -> bool {
    let is_device = || {
        let output = io::stdout().as_fd().try_clone_to_owned().map(File::from);
        let found = output.and_then(|output| output.metadata());
        found.is_ok_and(|found| found.file_type().is_char_device())
    };
    error.kind() == ErrorKind::BrokenPipe
        || (error.raw_os_error() == Some(Errno::EIO as i32) && is_device())
}

fn not_printed(error: &dyn Display, exit: Exit) -> Exit {
    message(format!("fccd: the result could not be printed: {error}"));
    match exit {
        Exit::Success => Exit::Failure,
        other => other,
    }
}

/// Prints a message.
pub(crate) fn message(text: impl Display) {
    if let Err(line) = printer::queued(line(text)) {
        write(&line);
    }
}

/// A text with its end of line. Names of files and keys in it may contain
/// anything.
fn line(text: impl Display) -> String {
    let words = std::env::args_os().skip(1);
    let words = words.map(|word| word.to_string_lossy().into_owned());
    with_end(printable(&in_one_line(text.to_string(), words)))
}

/// A text with the ends of lines in words of the command line as `\n`: they would begin a
/// line that is no message.
fn in_one_line(mut text: String, words: impl Iterator<Item = String>) -> String {
    for word in words {
        let name = word.split_once('=').map_or(&*word, |(_, name)| name);
        if name.contains('\n') && !name.trim().is_empty() {
            text = text.replace(name, &name.replace('\n', "\\n"));
        }
    }
    text
}

fn with_end(mut text: String) -> String {
    text.push('\n');
    text
}

fn write(line: &str) {
    // A failure to print a message cannot be reported.
    let _ = io::stderr().write_all(line.as_bytes());
}

/// Until the returned value is dropped, nothing that is printed keeps the caller waiting,
/// except for a limited time at the end.
pub(crate) fn in_background() -> Option<Printer> {
    Printer::begin(write)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_does_not_begin_a_line() {
        let words = ["check", "a\nb.toml", "--config=c\nd.toml", "\n"];
        let words = words.map(str::to_owned).into_iter();
        let text = "a\nb.toml: wrong\nc\nd.toml: wrong".to_owned();
        let said = "a\\nb.toml: wrong\nc\\nd.toml: wrong";
        assert_eq!(in_one_line(text, words), said);
    }
}
