//! The folder of the recordings, and how its size is limited.

use std::fs;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use super::{disk, name};

/// The recordings in a folder, oldest first; none if it cannot be read. What is in a
/// folder of others may be much, so no file is looked at.
pub(super) fn recordings(folder: &Path) -> Vec<PathBuf> {
    let found = fs::read_dir(folder).into_iter().flatten();
    let mut recordings: Vec<PathBuf> = found
        .filter_map(Result::ok)
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()))
        .map(|entry| entry.path())
        .filter(|path| name::is_recording(path))
        .collect();
    // Those of one folder differ in their ends.
    recordings.sort_by(|one, other| one.as_os_str().cmp(other.as_os_str()));
    recordings
}

/// The unit of `st_blocks`, inode(7).
const BLOCK_BYTES: u64 = 512;

/// Deletes the oldest recordings until the folder's recordings take at most
/// `keep_bytes`. Recordings being written are kept. Returns the deleted ones.
pub(super) fn keep_below(folder: &Path, keep_bytes: u64) -> Vec<PathBuf> {
    let sizes: Vec<(PathBuf, u64)> = recordings(folder)
        .into_iter()
        .filter_map(|path| {
            let found = fs::metadata(&path).ok()?;
            // A file may claim terabytes that no disk has.
            let bytes = found.len().min(found.blocks().saturating_mul(BLOCK_BYTES));
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
        .into_iter()
        .filter(|path| !kept.contains(path))
        .find(|path| disk::may_be_deleted(path) && fs::remove_file(path).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Another user can make one, and the recordings of this one would be deleted.
    #[test]
    fn a_file_without_content_takes_no_place() {
        let folder = tempfile::tempdir().unwrap();
        let [own, sparse] = ["2026-11-20T04-21-33.512Z", "2026-11-21T04-21-33.512Z"]
            .map(|stamp| folder.path().join(format!("{stamp}-c172-01.mcap")));
        fs::write(&own, vec![1; 100_000]).unwrap();
        fs::File::create(&sparse).unwrap().set_len(2 << 40).unwrap();
        assert!(keep_below(folder.path(), 1_000_000).is_empty());
        assert_eq!(keep_below(folder.path(), 50_000), [own]);
    }
}
