//! Releasing the controls on behalf of a process that was killed.
//!
//! A simulator never clears its overrides by itself, and a process that is killed can
//! do nothing more. So another process, the release helper, waits at the end of a
//! pipe: through it it is [told](Told) where control is held, before anything is
//! written there, and it closes when the first process ends for any reason. What is
//! held then, the helper [releases](release()). How the helper is started is the
//! host's.

mod pipes;
mod told;

use std::io;
use std::thread;
use std::time::{Duration, Instant};

use fcc_core::framework::{ActuatorFault, ControlAuthority, PlantId, Released};

use crate::config::{Config, ConfigError};
pub use pipes::{Growing, HelperPipes};
#[cfg(fuzzing)]
pub use told::held_after;
pub use told::{Line, Told};

/// How long a helper repeats the release: a simulator that loads scenery hangs
/// for some time.
const RELEASE_FOR: Duration = Duration::from_secs(120);

/// The pause after a release that could not even be tried.
const AGAIN_AFTER: Duration = Duration::from_millis(100);

/// A configuration as one line: a string of JSON.
///
/// # Errors
/// When it cannot be written as text.
pub fn in_one_line(config: &Config) -> io::Result<String> {
    let text = toml::to_string(config).map_err(io::Error::other)?;
    Ok(serde_json::to_string(&text)?)
}

/// The configuration of such a line.
///
/// # Errors
/// When it is none.
pub fn from_one_line(line: &str) -> Result<Config, NoConfigError> {
    let text: String = serde_json::from_str(line)?;
    Ok(Config::parse(&text, "standard input")?)
}

/// A line that is no configuration.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum NoConfigError {
    /// It is not a string.
    #[error("the first line is not a configuration as a string of JSON: {0}")]
    Line(#[from] serde_json::Error),
    /// The string is not a configuration.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

/// Releases what is held until that is confirmed, for two minutes at most. What
/// prevents it may pass: a network that is down, ports that another program has; and
/// what has ended may have been a relay, behind which the simulator is.
///
/// # Errors
/// When nothing can be sent to this plant.
pub fn release(
    authority: &dyn ControlAuthority,
    plant: &PlantId,
    is_cancelled: &mut dyn FnMut() -> bool,
) -> Result<Released, ActuatorFault> {
    let begun = Instant::now();
    loop {
        let left = RELEASE_FOR.saturating_sub(begun.elapsed());
        match authority.release(plant, left, is_cancelled) {
            Err(_) | Ok(Released::Unreachable) if left > AGAIN_AFTER && !is_cancelled() => {
                thread::sleep(AGAIN_AFTER);
            }
            result => return result,
        }
    }
}
