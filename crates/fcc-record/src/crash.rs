//! What a program that was killed left behind.

use std::path::Path;
use std::time::Duration;

use super::reader::Recording;
use super::recover::{RecoverError, Recovered, recover_within};
use super::{disk, folder};

/// A start must not wait for long: a recording that takes longer is left to
/// `fccd recover`. An hour at 100 Hz takes a few seconds.
const LIMIT: Duration = Duration::from_secs(5);

/// Repairs the newest recording in a folder if it was cut off and nobody is
/// writing it. None if there is nothing to repair; takes 5 s at most.
///
/// # Errors
/// When it is cut and could not be repaired; it is as it was then.
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
