//! Prints results on standard output and messages on standard error.
//!
//! Everything is printed through here, because `print!` and `eprint!` panic
//! when the output cannot be written: a pipe whose reader has left, a full
//! disk, a closed terminal. Here a result that cannot be printed gives an exit
//! code, and a message that cannot be printed is dropped.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::os::fd::AsFd as _;
use std::os::unix::fs::FileTypeExt as _;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fcc_telemetry::{printable, printable_json};
use nix::errno::Errno;
use serde::Serialize;

use crate::exit::Exit;
use crate::process::standard_output;

/// Prints a result. Returns `exit`, or a failure if that was a success and the
/// result could not be printed. A reader that has left (`| head -1`, or a closed
/// terminal) is no failure.
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
    printed(StandardOutput.write_all(bytes), exit)
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
    let line = line(text);
    match background().as_mut() {
        Some(lines) => lines.give(line),
        None => write(&line),
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

/// Messages that may wait while the terminal is blocked: some minutes of
/// status.
const WAITING: usize = 256;
/// How long the end of a flight waits for printing.
const PATIENCE: Duration = Duration::from_secs(1);

static BACKGROUND: Mutex<Option<Queue>> = Mutex::new(None);

fn background() -> MutexGuard<'static, Option<Queue>> {
    BACKGROUND.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Until the returned value is dropped, messages are printed by a separate
/// thread, so that a blocked terminal does not delay the caller. Messages that
/// do not fit into the queue are dropped, and their number is printed later.
pub(crate) fn in_background() -> Option<Background> {
    let (to, from) = sync_channel::<String>(WAITING);
    // Without the thread, printing waits for the terminal.
    let printer = thread::Builder::new()
        .name("fccd-printer".to_owned())
        // With locked memory, all of a stack is resident.
        .stack_size(256 << 10)
        .spawn(move || from.iter().for_each(|line| write(&line)))
        .ok()?;
    *background() = Some(Queue { to, dropped: 0 });
    Some(Background { printer })
}

/// The queue of messages for the thread that prints them.
struct Queue {
    to: SyncSender<String>,
    dropped: u64,
}

impl Queue {
    fn give(&mut self, line: String) {
        if self.dropped > 0 {
            let gap = format!(
                "{} lines were dropped here: the terminal was blocked\n",
                self.dropped
            );
            if self.to.try_send(gap).is_err() {
                self.dropped += 1;
                return;
            }
            self.dropped = 0;
        }
        if self.to.try_send(line).is_err() {
            self.dropped += 1;
        }
    }
}

/// The thread that prints messages.
pub(crate) struct Background {
    printer: JoinHandle<()>,
}

impl Drop for Background {
    /// Waits for a limited time until all are printed.
    fn drop(&mut self) {
        // The thread ends with its last sender.
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
    fn a_name_does_not_begin_a_line() {
        let words = ["check", "a\nb.toml", "--config=c\nd.toml", "\n"];
        let words = words.map(str::to_owned).into_iter();
        let text = "a\nb.toml: wrong\nc\nd.toml: wrong".to_owned();
        let said = "a\\nb.toml: wrong\nc\\nd.toml: wrong";
        assert_eq!(in_one_line(text, words), said);
    }

    #[test]
    fn dropped_lines_are_counted_where_they_are_missing() {
        let (to, from) = sync_channel(2);
        let mut lines = Queue { to, dropped: 0 };
        for line in ["a", "b", "c", "d"] {
            lines.give(line.to_owned());
        }
        let printed: Vec<String> = from.try_iter().collect();
        assert_eq!(printed, ["a", "b"]);
        lines.give("e".to_owned());
        let printed: Vec<String> = from.try_iter().collect();
        assert_eq!(
            printed,
            ["2 lines were dropped here: the terminal was blocked\n", "e"]
        );
    }
}
