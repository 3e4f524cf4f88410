//! Finds the recording of a program that was killed.

use std::fs;
use std::path::{Path, PathBuf};

use super::opening::is_owned;
use super::reader::Recording;
use super::{folder, name};

/// The newest recording of this user, or root's, in a folder, if it is unfinished and
/// not being written: to be [recovered](super::recover_while). Those of the flight that
/// began at `started_unix_ns`, with this offset of its clock, are passed over.
pub fn last_unfinished(
    folder: &Path,
    started_unix_ns: u64,
    clock_offset_ns: i64,
) -> Option<PathBuf> {
    let is_own = |path: &PathBuf| fs::symlink_metadata(path).is_ok_and(|of| is_owned(&of));
    // No folder, no recordings. Another user's would hide the one that is looked for.
    let recordings = folder::recordings(folder).into_iter().rev().filter(is_own);
    let (last, recording) = recordings
        .map(|path| (Recording::open(&path).ok(), path))
        .find_map(|(recording, path)| {
            // Without its description it has just been begun. A board without a clock may have
            // begun another one at the same time, by its clock.
            let offset_ns = recording
                .as_ref()
                .map(|found| found.about().clock_offset_ns);
            let is_this = offset_ns.is_none_or(|offset_ns| offset_ns == clock_offset_ns)
                && name::is_of_flight(&path, started_unix_ns);
            (!is_this).then_some((path, recording))
        })?;
    let recording = recording?;
    (!recording.is_whole() && !recording.is_being_written()).then_some(last)
}
