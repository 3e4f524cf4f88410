//! Repairs the recording of a program that was killed.

use std::path::Path;
use std::time::Duration;

use super::reader::Recording;
use super::recover::{RecoverError, Recovered, recover_within};
use super::{disk, folder};

/// A start must not wait for long: a longer recording is left to `fccd
/// recover`. An hour at 100 Hz takes a few seconds.
const LIMIT: Duration = Duration::from_secs(5);

/// Repairs the newest recording in a folder if it is unfinished and not being
/// written. `None` if there is nothing to repair. Takes at most 5 s.
///
/// # Errors
/// When it is unfinished and cannot be repaired. The file is then unchanged.
pub fn repair_last(folder: &Path) -> Result<Option<Recovered>, RecoverError> {
    // No folder, no recordings.
    let Some(last) = folder::recordings(folder)
        .ok()
        .and_then(|mut all| all.pop())
    else {
        return Ok(None);
    };
    let is_cut = Recording::open(&last).is_ok_and(|recording| !recording.is_whole());
    if !is_cut || disk::is_being_written(&last) {
        return Ok(None);
    }
    recover_within(&last, LIMIT).map(Some)
}
