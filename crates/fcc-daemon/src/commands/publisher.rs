//! `fccd publisher`: publishes live telemetry for the daemon that started it.

use std::io;

use super::failure::Failure;
use super::vehicles::Kind;
use crate::exit::Exit;
use crate::process::{begin_helper, outlive_signals};

/// Publishes until the daemon ends. What ended it sooner is known to the
/// daemon, which starts it again.
pub(super) fn publisher(vehicle: Option<&str>) -> Result<Exit, Failure> {
    begin_helper();
    outlive_signals().map_err(|error| {
        Failure::new(format_args!("publisher: signals cannot be caught: {error}"))
    })?;
    // A panic because of damaged shared memory is told by the daemon, not as
    // often as it happens.
    std::panic::set_hook(Box::new(|_| {}));
    match (Kind::live(vehicle).publish)(&io::stdin()) {
        Ok(()) => Ok(Exit::Success),
        Err(error @ fcc_live::RelayError::Nothing) => {
            Err(Failure::new(format_args!("publisher: {error}")))
        }
        // Told to the daemon.
        Err(_) => Ok(Exit::Failure),
    }
}
