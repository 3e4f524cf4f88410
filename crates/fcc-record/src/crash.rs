//! Finds the recording of a program that was killed.

use std::path::{Path, PathBuf};

use super::reader::Recording;
use super::{folder, name};

/// The newest recording in a folder, if it is unfinished and not being written:
/// to be [recovered](super::recover_while). Those of the flight that began at
/// `started_unix_ns` are passed over.
pub fn last_unfinished(folder: &Path, started_unix_ns: u64) -> Option<PathBuf> {
    // No folder, no recordings.
    let earlier = folder::found(folder)
        .ok()?
        .filter(|path| !name::is_of_flight(path, started_unix_ns));
    let last = earlier.max_by(|one, other| one.as_os_str().cmp(other.as_os_str()))?;
    let recording = Recording::open(&last).ok()?;
    (!recording.is_whole() && !recording.is_being_written()).then_some(last)
}
