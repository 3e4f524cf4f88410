//! `fccd release-helper`: releases the controls of a daemon that was killed.

use std::fs::OpenOptions;
use std::io::{self, BufReader};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

use fcc_core::framework::Released;
use nix::libc::{O_NOCTTY, O_NOFOLLOW, O_NONBLOCK};
use nix::unistd::{dup2_stderr, ttyname};

use super::failure::Failure;
use crate::exit::Exit;
use crate::output;
use crate::process::{DaemonPipe, begin_helper, outlive_signals, run_release_helper};

/// Waits until the daemon that started this has ended.
pub(super) fn release_helper() -> Result<Exit, Failure> {
    begin_helper();
    let daemon = BufReader::new(DaemonPipe::new());
    let terminal = leave_terminal();
    let failure = |error| Failure::new(format_args!("release helper: {error}"));
    outlive_signals().map_err(|error| {
        Failure::new(format_args!(
            "release helper: signals cannot be caught: {error}"
        ))
    })?;
    let Some(result) = run_release_helper(daemon).map_err(failure)? else {
        return Ok(Exit::Success);
    };
    let plant = result.plant;
    let (text, exit) = match result.released {
        Released::Unreachable => return Ok(Exit::Success),
        Released::Cancelled | Released::Confirmed => {
            (format!("; {plant} was released"), Exit::Success)
        }
        Released::Unconfirmed | Released::Refused => (
            format!(
                ", and {plant} did not confirm the release of its controls: {}",
                result.by_hand
            ),
            Exit::NotReleased,
        ),
    };
    if let Some(terminal) = terminal {
        return_to(&terminal);
    }
    output::message(format!("fccd release-helper: the daemon has ended{text}"));
    Ok(exit)
}

/// Closes the terminal, if messages go to one; returns its path.
fn leave_terminal() -> Option<PathBuf> {
    let path = ttyname(io::stderr()).ok()?;
    let nowhere = OpenOptions::new().write(true).open("/dev/null").ok()?;
    dup2_stderr(nowhere).ok()?;
    Some(path)
}

/// Messages go to the terminal again, if it still exists; one that is blocked
/// is not waited for.
fn return_to(terminal: &Path) {
    let opened = OpenOptions::new()
        .write(true)
        .custom_flags(O_NOCTTY | O_NONBLOCK | O_NOFOLLOW)
        .open(terminal);
    if let Ok(opened) = opened {
        let _ = dup2_stderr(opened);
    }
}
