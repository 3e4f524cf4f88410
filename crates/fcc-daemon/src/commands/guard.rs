//! `fccd guard`: what is left of a daemon that was killed.

use std::io;

use fcc_xplane::Released;
use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM};

use super::fail;
use crate::exit::Exit;
use crate::output;
use fcc_flight::flight::run_release_helper;

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
    match run_release_helper(io::stdin().lock()) {
        Ok(None | Some((_, Released::Gone))) => Exit::Success,
        Ok(Some((simulator, Released::CalledOff))) => {
            output::message(format!(
                "fccd guard: the daemon is gone; another has taken X-Plane at {simulator} over"
            ));
            Exit::Success
        }
        Ok(Some((simulator, Released::Confirmed))) => {
            output::message(format!(
                "fccd guard: the daemon is gone; X-Plane at {simulator} was released"
            ));
            Exit::Success
        }
        Ok(Some((simulator, Released::Unconfirmed))) => {
            output::message(format!(
                "fccd guard: the daemon is gone, and X-Plane at {simulator} does not show that it \
                 has its controls back: switch off override_joystick and override_throttles there"
            ));
            Exit::NotReleased
        }
        Err(error) => fail(&format!("guard: {error}")),
    }
}
