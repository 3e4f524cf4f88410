//! Finds the recording of a program that was killed.

use std::fs;
use std::path::{Path, PathBuf};

use super::opening::is_owned;
use super::reader::Recording;
use super::{folder, name};

/// The newest recording of this user, or root's, in a folder, if it is unfinished and
/// not being written: to be [recovered](super::recover_while). Those of the flight that
/// began at `started_unix_ns` are passed over.
pub fn last_unfinished(folder: &Path, started_unix_ns: u64) -> Option<PathBuf> {
    let is_own = |path: &PathBuf| fs::symlink_metadata(path).is_ok_and(|of| is_owned(&of));
    // No folder, no recordings. Another user's would hide the one that is looked for.
    let last = folder::recordings(folder)
        .into_iter()
        .rev()
        .filter(|path| !name::is_of_flight(path, started_unix_ns))
        .find(is_own)?;
    let recording = Recording::open(&last).ok()?;
    (!recording.is_whole() && !recording.is_being_written()).then_some(last)
}
