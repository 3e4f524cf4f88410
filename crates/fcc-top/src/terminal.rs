//! The terminal: keys, drawing, and restoring it.

use std::fmt;
use std::io::{self, IsTerminal as _};
use std::mem::ManuallyDrop;
use std::os::fd::AsFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use fcc_live::{WatchError, WatcherOf};
use fcc_telemetry::Instance;
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use ratatui::DefaultTerminal;
use ratatui::crossterm::terminal::{disable_raw_mode, size};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level;

use super::picture::Picture;
use super::screen;
use super::watched::Watched;

/// Time between drawings: short enough for an attitude, long enough for a small
/// board and a slow line.
const REDRAW_EVERY: Duration = Duration::from_millis(67);
/// Time without messages before the daemon's process is checked.
const SILENCE: Duration = Duration::from_secs(1);
/// Time for which a signal waits for a drawing that the terminal does not
/// accept.
const STOPPED: Duration = Duration::from_secs(1);

/// More than any screen has. Each character takes memory and time.
const MOST_CHARACTERS: u32 = 1_000_000;

/// Refuses a terminal that reports a larger size.
fn check_size() -> io::Result<()> {
    let (columns, rows) = size()?;
    if u32::from(columns) * u32::from(rows) > MOST_CHARACTERS {
        return Err(io::Error::other(format!(
            "it has {columns} x {rows} characters: top draws at most {MOST_CHARACTERS}; set its \
             size with stty"
        )));
    }
    Ok(())
}

/// Reason why a loop cannot be shown.
#[derive(Debug)]
pub enum TopError {
    /// There is no loop to watch.
    Watch(WatchError),
    /// The output is not a terminal.
    NoTerminal,
    /// The terminal failed.
    Terminal(io::Error),
}

impl fmt::Display for TopError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Watch(error) => error.fmt(f),
            Self::NoTerminal => f.write_str("top needs a terminal: run it in one, or use --json"),
            Self::Terminal(error) => write!(f, "the terminal: {error}"),
        }
    }
}

impl std::error::Error for TopError {}

/// Shows the loop of an instance until `q` is pressed.
///
/// # Errors
/// When there is no such loop or no terminal.
pub fn top<C: Watched>(instance: &Instance) -> Result<(), TopError> {
    let watcher = WatcherOf::<C>::open(instance).map_err(TopError::Watch)?;
    if !io::stdout().is_terminal() || !io::stdin().is_terminal() {
        return Err(TopError::NoTerminal);
    }
    watch(instance, watcher).map_err(TopError::Terminal)
}

fn watch<C: Watched>(instance: &Instance, watcher: WatcherOf<C>) -> io::Result<()> {
    check_size()?;
    let end_requested = end_by_signals()?;
    // From here on a panic restores the terminal before its message is printed.
    let terminal = ratatui::try_init().inspect_err(|_| {
        let _ = ratatui::try_restore();
    })?;
    // Dropping it prints a message about a closed terminal with a macro that
    // panics there.
    let mut terminal = ManuallyDrop::new(terminal);
    show(&mut terminal, instance, watcher, &end_requested)
        .and(terminal.show_cursor())
        .and(ratatui::try_restore())
}

/// A flag that a signal sets. A stopped terminal blocks the drawing: then the
/// signal ends the program without it.
fn end_by_signals() -> io::Result<Arc<AtomicBool>> {
    let end_requested = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&end_requested);
    let mut signals = Signals::new([SIGTERM, SIGINT, SIGHUP])?;
    thread::Builder::new()
        .name("top-signals".to_owned())
        .spawn(move || {
            if let Some(signal) = signals.forever().next() {
                flag.store(true, Ordering::Relaxed);
                thread::sleep(STOPPED);
                let _ = disable_raw_mode();
                low_level::exit(128 + signal);
            }
        })?;
    Ok(end_requested)
}

fn show<C: Watched>(
    terminal: &mut DefaultTerminal,
    instance: &Instance,
    watcher: WatcherOf<C>,
    end_requested: &AtomicBool,
) -> io::Result<()> {
    let mut picture = Picture::new(&watcher);
    let mut watcher = Some(watcher);
    let mut received = Instant::now();
    while !end_requested.load(Ordering::Relaxed) {
        let next = Instant::now() + REDRAW_EVERY;
        match watcher.as_mut().map(|watcher| picture.update(watcher)) {
            Some(Ok(true)) => received = Instant::now(),
            Some(Ok(false)) if received.elapsed() < SILENCE => {}
            Some(Ok(false)) if watcher.as_mut().is_some_and(|watcher| watcher.is_alive()) => {
                received = Instant::now();
            }
            Some(Ok(false) | Err(_)) => {
                picture.ended = true;
                watcher = None;
                received = Instant::now();
            }
            // It may be started again.
            None if received.elapsed() >= SILENCE => {
                received = Instant::now();
                if let Ok(found) = WatcherOf::open(instance) {
                    picture = Picture::new(&found);
                    watcher = Some(found);
                }
            }
            None => {}
        }
        check_size()?;
        terminal.draw(|frame| screen::draw(frame, instance, &picture))?;
        while let Some(key) = key_before(next)? {
            if key == Key::Quit {
                return Ok(());
            }
            if Instant::now() >= next {
                break;
            }
        }
    }
    Ok(())
}

/// The key that was pressed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Key {
    Quit,
    Other,
}

impl Key {
    /// Decodes the bytes of a terminal in raw mode.
    fn of(bytes: &[u8]) -> Self {
        const CTRL_C: u8 = 3;
        const ESCAPE: u8 = 0x1b;
        match bytes {
            // Alone: followed by others, it begins the code of a key.
            [b'q' | CTRL_C, ..] | [ESCAPE] => Self::Quit,
            _ => Self::Other,
        }
    }
}

/// The next key, if one is pressed until then.
///
/// # Errors
/// When the terminal is closed. (Crossterm's own reader would loop there.)
fn key_before(then: Instant) -> io::Result<Option<Key>> {
    let input = io::stdin();
    let mut fds = [PollFd::new(input.as_fd(), PollFlags::POLLIN)];
    let left = then.saturating_duration_since(Instant::now());
    // Rounded up to a millisecond: 0 would not wait.
    let timeout =
        PollTimeout::try_from(left + Duration::from_millis(1)).unwrap_or(PollTimeout::ZERO);
    match poll(&mut fds, timeout) {
        // A signal, or no input.
        Err(Errno::EINTR) | Ok(0) => return Ok(None),
        Err(error) => return Err(error.into()),
        Ok(_) => {}
    }
    let mut bytes = [0; 64];
    match nix::unistd::read(&input, &mut bytes) {
        Ok(0) => Err(io::Error::other("closed")),
        Ok(length) => Ok(bytes.get(..length).map(Key::of)),
        Err(Errno::EINTR | Errno::EAGAIN) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes from xterm's manual on control sequences.
    #[test]
    fn q_escape_and_control_c_quit_and_an_arrow_does_not() {
        for bytes in [&b"q"[..], b"\x1b", b"\x03"] {
            assert_eq!(Key::of(bytes), Key::Quit, "{bytes:?}");
        }
        for bytes in [&b"\x1b[A"[..], b"x", b"\x1bOq"] {
            assert_eq!(Key::of(bytes), Key::Other, "{bytes:?}");
        }
    }
}
