//! The folder of the recordings, and how its size is limited.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::{disk, name};

/// The recordings in a folder, oldest first.
///
/// # Errors
/// When the folder cannot be read.
pub(super) fn recordings(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found: Vec<PathBuf> = fs::read_dir(folder)?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| name::is_recording(path) && !path.is_symlink() && path.is_file())
        .collect();
    found.sort();
    Ok(found)
}

/// Deletes the oldest recordings until the folder's recordings take at most
/// `keep_bytes`. Recordings being written are kept. Returns the deleted ones.
pub(super) fn keep_below(folder: &Path, keep_bytes: u64) -> Vec<PathBuf> {
    let sizes: Vec<(PathBuf, u64)> = recordings(folder)
        .unwrap_or_default()
        .into_iter()
        .filter_map(|path| {
            let bytes = fs::metadata(&path).ok()?.len();
            Some((path, bytes))
        })
        .collect();
    let mut total: u64 = sizes.iter().map(|(_, bytes)| bytes).sum();
    let mut deleted = Vec::new();
    for (path, bytes) in sizes {
        if total <= keep_bytes {
            break;
        }
        if disk::may_be_deleted(&path) && fs::remove_file(&path).is_ok() {
            total -= bytes;
            deleted.push(path);
        }
    }
    deleted
}

/// Deletes the oldest recording that is not being written and not in `kept`;
/// returns it, if there was one.
pub(super) fn delete_oldest(folder: &Path, kept: &[PathBuf]) -> Option<PathBuf> {
    recordings(folder)
        .ok()?
        .into_iter()
        .filter(|path| !kept.contains(path))
        .find(|path| disk::may_be_deleted(path) && fs::remove_file(path).is_ok())
}
