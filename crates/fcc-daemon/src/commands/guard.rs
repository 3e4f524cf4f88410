//! `fccd guard`: what is left of a daemon that was killed.

use std::io;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use super::fail;
use crate::exit::Exit;
use crate::flight::stand_guard;

/// Waits until the daemon that started this is gone.
pub(super) fn guard() -> Exit {
    // Whoever ends the daemon by a signal to all its processes wants the
    // controls back first: the guard ends by the daemon's end and no sooner.
    for signal in [SIGTERM, SIGINT, SIGHUP] {
        let ignored = signal_hook::flag::register(signal, std::sync::Arc::default());
        if let Err(error) = ignored {
            return fail(&format!("guard: signals cannot be caught: {error}"));
        }
    }
    match stand_guard(io::stdin().lock()) {
        Ok(None) => Exit::Success,
        Ok(Some(simulator)) => {
            eprintln!("fccd guard: the daemon is gone; X-Plane at {simulator} was released");
            Exit::Success
        }
        Err(error) => fail(&format!("guard: {error}")),
    }
}
