//! Free space where shared memory is.

use std::fs::{File, OpenOptions};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use nix::errno::Errno;
use nix::fcntl::{FallocateFlags, fallocate};
use nix::sys::statvfs::statvfs;

use super::place::entries;

/// Space that publishing may need at any time: the largest number of records,
/// events and watchers' connections takes some 3 MiB.
pub(super) const NEEDED_BYTES: u64 = 8 * 1_024 * 1_024;

/// Below this, nothing is published until there is space again. Touching a page
/// of shared memory that cannot be allocated kills the process.
pub(super) const LEAST_BYTES: u64 = 4 * 1_024 * 1_024;

/// What a watcher needs for its connections, with a margin.
pub(super) const WATCHER_BYTES: u64 = 1_024 * 1_024;

fn free_at(folder: &Path) -> Option<u64> {
    let space = statvfs(folder).ok()?;
    // A file system without a limit reports 0 blocks.
    (space.blocks() > 0)
        .then(|| (space.blocks_available() as u64).saturating_mul(space.fragment_size() as u64))
}

/// Why there is too little in a folder, as text; none if there is enough, or it
/// is unknown how much.
pub(super) fn too_little(folder: &Path, needed_bytes: u64) -> Option<String> {
    let free = free_at(folder)?;
    (free < needed_bytes).then(|| {
        format!(
            "{} has {} KiB free and {} KiB may be needed: delete files there, or mount it with a \
             larger size",
            folder.display(),
            free / 1_024,
            needed_bytes / 1_024
        )
    })
}

/// Allocates what the files in a folder lack, so that using them cannot fail
/// later.
///
/// # Errors
/// When there is no space, as text.
pub(super) fn allocate_all_in(folder: &Path) -> Result<(), String> {
    for path in entries(folder) {
        // Another program may remove its own meanwhile.
        let Ok(file) = OpenOptions::new().write(true).open(&path) else {
            continue;
        };
        allocate(&file).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}

fn allocate(file: &File) -> nix::Result<()> {
    /// The unit of [`MetadataExt::blocks`].
    const BLOCK_BYTES: u64 = 512;
    let Ok(found) = file.metadata() else {
        return Ok(());
    };
    if !found.is_file() || found.blocks().saturating_mul(BLOCK_BYTES) >= found.size() {
        return Ok(());
    }
    // 32 bits on a 32-bit board.
    let bytes = found.size().try_into().map_err(|_| Errno::EFBIG)?;
    fallocate(file, FallocateFlags::FALLOC_FL_KEEP_SIZE, 0, bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_folder_does_not_stop_publishing() {
        assert_eq!(free_at(Path::new("/no/such/folder")), None);
    }

    #[test]
    fn more_than_all_memory_is_not_free() {
        assert!(too_little(Path::new("/dev/shm"), u64::MAX).is_some());
    }
}
