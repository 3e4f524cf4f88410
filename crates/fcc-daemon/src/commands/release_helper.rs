//! `fccd release-helper`: releases the controls of a daemon that was killed.

use std::io;

use fcc_core::framework::Released;
use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM};

use super::failure::Failure;
use crate::exit::Exit;
use crate::output;
use crate::process::{run_release_helper, tolerate};

/// Waits until the daemon that started this has ended.
pub(super) fn release_helper() -> Result<Exit, Failure> {
    // A signal to all processes of the daemon must not end the helper before
    // the controls are released: it ends only after the daemon's end. ABRT is
    // sent by a service manager's watchdog.
    let caught = [SIGTERM, SIGINT, SIGHUP, SIGABRT]
        .into_iter()
        .try_for_each(|signal| {
            signal_hook::flag::register(signal, std::sync::Arc::default()).map(drop)
        });
    let failure = |error| Failure::new(format_args!("release helper: {error}"));
    caught.and_then(|()| tolerate()).map_err(|error| {
        Failure::new(format_args!(
            "release helper: signals cannot be caught: {error}"
        ))
    })?;
    let Some(result) = run_release_helper(io::stdin().lock()).map_err(failure)? else {
        return Ok(Exit::Success);
    };
    let plant = result.plant;
    let (text, exit) = match result.released {
        Released::Unreachable => return Ok(Exit::Success),
        Released::Cancelled => (
            format!("; another daemon has taken over {plant}"),
            Exit::Success,
        ),
        Released::Confirmed => (format!("; {plant} was released"), Exit::Success),
        Released::Unconfirmed => (
            format!(
                ", and {plant} did not confirm the release of its controls: {}",
                result.by_hand
            ),
            Exit::NotReleased,
        ),
    };
    output::message(format!("fccd release-helper: the daemon has ended{text}"));
    Ok(exit)
}
