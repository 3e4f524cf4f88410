//! Finds the recording of a program that was killed.

use std::path::{Path, PathBuf};

use super::reader::Recording;
use super::{disk, folder};

/// The newest recording in a folder, if it is unfinished and not being written:
/// to be [recovered](super::recover_while).
pub fn last_unfinished(folder: &Path) -> Option<PathBuf> {
    // No folder, no recordings.
    let last = folder::recordings(folder).ok()?.pop()?;
    let is_cut = Recording::open(&last).is_ok_and(|recording| !recording.is_whole());
    (is_cut && !disk::is_being_written(&last)).then_some(last)
}
