//! The folder of the recordings, their order, and how its size is limited.
//!
//! A clock may go back: a board without one begins with 1970, or with the time of
//! its last shutdown. So each file is listed in the folder when it is begun. What
//! is not listed, such as a copy, is older, and in the order of the names.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use super::{disk, name, opening};

/// The file that lists the recordings of its folder, the oldest first, in lines.
const ORDER: &str = ".order";
const MAX_ORDER_BYTES: u64 = 16 << 20;

/// Lists a file as the newest of its folder. The list is replaced in one step, and
/// names no file that is gone.
pub(super) fn list_as_newest(path: &Path) -> io::Result<()> {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
        return Ok(());
    };
    let listed = listed(folder);
    let mut known = recordings_by(folder, &listed);
    known.retain(|other| other != path && position(&listed, other).is_some());
    let (order, beside) = (folder.join(ORDER), folder.join(".order.unfinished"));
    let mut file = opening::create_recording_anew(&beside)?;
    let names = known.iter().filter_map(|path| path.file_name());
    for name in names.chain([name]) {
        writeln!(file, "{}", name.to_string_lossy())?;
    }
    file.sync_all()?;
    fs::rename(&beside, &order)?;
    disk::sync_folder_of(&order)
}

/// The places of the files in the list; none if it is missing, or of another user.
fn listed(folder: &Path) -> HashMap<String, usize> {
    let list = opening::read_own_file(&folder.join(ORDER), MAX_ORDER_BYTES).unwrap_or_default();
    let names = String::from_utf8_lossy(&list);
    let names = names.lines().map(str::to_owned);
    names.zip(0..).collect()
}

fn position(listed: &HashMap<String, usize>, path: &Path) -> Option<usize> {
    let name = path.file_name().and_then(OsStr::to_str);
    name.and_then(|name| listed.get(name)).copied()
}

/// Sorts the files of a folder, the oldest first.
pub(super) fn sort(folder: &Path, files: &mut [PathBuf]) {
    sort_by(&listed(folder), files);
}

fn sort_by(listed: &HashMap<String, usize>, files: &mut [PathBuf]) {
    files.sort_by_cached_key(|path| (position(listed, path), path.as_os_str().to_owned()));
}

/// The recordings in a folder, oldest first; none if it cannot be read. What is in a
/// folder of others may be much, so no recording is looked at.
pub(super) fn recordings(folder: &Path) -> Vec<PathBuf> {
    recordings_by(folder, &listed(folder))
}

fn recordings_by(folder: &Path, listed: &HashMap<String, usize>) -> Vec<PathBuf> {
    let found = fs::read_dir(folder).into_iter().flatten();
    let mut recordings: Vec<PathBuf> = found
        .filter_map(Result::ok)
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()))
        .map(|entry| entry.path())
        .filter(|path| name::is_recording(path))
        .collect();
    sort_by(listed, &mut recordings);
    recordings
}

/// The unit of `st_blocks`, inode(7).
const BLOCK_BYTES: u64 = 512;

/// Deletes the oldest recordings until the folder's recordings take at most
/// `keep_bytes`. Recordings being written, and those in `kept`, are not deleted.
/// Returns the deleted ones.
pub(super) fn keep_below(folder: &Path, keep_bytes: u64, kept: &[PathBuf]) -> Vec<PathBuf> {
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
        if !kept.contains(&path) && disk::may_be_deleted(&path) && fs::remove_file(&path).is_ok() {
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
        assert!(keep_below(folder.path(), 1_000_000, &[]).is_empty());
        assert_eq!(keep_below(folder.path(), 50_000, &[]), [own]);
    }

    /// A board whose clock was right in 2026, begins with 1970, and has a copy of 2031.
    #[test]
    fn the_order_is_that_of_the_flights_and_not_of_the_clock() {
        let folder = tempfile::tempdir().unwrap();
        let file = |stamp: &str| folder.path().join(format!("{stamp}-c172-01.mcap"));
        let [right, behind, newest, copy] = [
            file("2026-11-20T04-21-33.512Z"),
            file("1970-01-01T00-00-12.000Z"),
            file("1970-01-01T00-00-11.000Z"),
            file("2031-01-01T00-00-00.000Z"),
        ];
        for path in [&right, &behind, &newest] {
            fs::write(path, vec![1; 100_000]).unwrap();
            list_as_newest(path).unwrap();
        }
        fs::write(&copy, vec![1; 100_000]).unwrap();
        let all = [&copy, &right, &behind, &newest].map(PathBuf::clone);
        assert_eq!(recordings(folder.path()), all);
        // The first part of the flight in progress.
        let own = [right.clone()];
        assert_eq!(keep_below(folder.path(), 250_000, &own), [copy, behind]);
        list_as_newest(&right).unwrap();
        assert_eq!(recordings(folder.path()), [newest, right]);
        let list = fs::read_to_string(folder.path().join(ORDER)).unwrap();
        assert_eq!(list.lines().count(), 2, "what is gone is not listed");
    }
}
