//! `fccd guard`: what is left of a daemon that was killed.

use std::io;

use fcc_core::framework::Released;
use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM};

use super::fail;
use crate::exit::Exit;
use crate::output;
use crate::process::run_release_helper;

/// Waits until the daemon that started this is gone.
pub(super) fn guard() -> Exit {
    // Whoever ends the daemon by a signal to all its processes wants the
    // controls back first: the guard ends by the daemon's end and no sooner.
    // ABRT is what a service manager's watchdog sends.
    for signal in [SIGTERM, SIGINT, SIGHUP, SIGABRT] {
        let ignored = signal_hook::flag::register(signal, std::sync::Arc::default());
        if let Err(error) = ignored {
            return fail(&format!("guard: signals cannot be caught: {error}"));
        }
    }
    let given_back = match run_release_helper(io::stdin().lock()) {
        Ok(Some(given_back)) => given_back,
        Ok(None) => return Exit::Success,
        Err(error) => return fail(&format!("guard: {error}")),
    };
    let plant = given_back.plant;
    let (words, exit) = match given_back.released {
        Released::Unreachable => return Exit::Success,
        Released::Cancelled => (format!("; another has taken {plant} over"), Exit::Success),
        Released::Confirmed => (format!("; {plant} was released"), Exit::Success),
        Released::Unconfirmed => (
            format!(
                ", and {plant} does not show that it has its controls back: {}",
                given_back.by_hand
            ),
            Exit::NotReleased,
        ),
    };
    output::message(format!("fccd guard: the daemon is gone{words}"));
    exit
}
