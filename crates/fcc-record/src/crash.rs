//! Finds the recording of a program that was killed.

use std::path::{Path, PathBuf};

use super::folder;
use super::reader::Recording;

/// The newest recording in a folder, if it is unfinished and not being written:
/// to be [recovered](super::recover_while).
pub fn last_unfinished(folder: &Path) -> Option<PathBuf> {
    // No folder, no recordings.
    let last = folder::recordings(folder).ok()?.pop()?;
    let recording = Recording::open(&last).ok()?;
    (!recording.is_whole() && !recording.is_being_written()).then_some(last)
}
