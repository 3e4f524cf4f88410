//! Free space in the system's shared memory.

use std::path::Path;

use nix::sys::statvfs::statvfs;

/// Where Linux keeps shared memory.
pub(super) const SHARED_MEMORY: &str = "/dev/shm";

/// Space that publishing may need at any time: the largest number of records,
/// events and watchers' connections takes some 3 MiB.
pub(super) const NEEDED_BYTES: u64 = 8 * 1_024 * 1_024;

/// Below this, nothing is published until there is space again. Touching a page
/// of shared memory that cannot be allocated kills the process: a full
/// `/dev/shm` must never end a flight.
pub(super) const LEAST_BYTES: u64 = 4 * 1_024 * 1_024;

/// What a watcher needs for its connections, with a margin.
pub(super) const WATCHER_BYTES: u64 = 1_024 * 1_024;

/// Free shared memory; none if unknown, which does not stop publishing.
pub(super) fn free_bytes() -> Option<u64> {
    free_at(Path::new(SHARED_MEMORY))
}

fn free_at(folder: &Path) -> Option<u64> {
    let space = statvfs(folder).ok()?;
    // A file system without a limit reports 0 blocks.
    (space.blocks() > 0)
        .then(|| (space.blocks_available() as u64).saturating_mul(space.fragment_size() as u64))
}

/// Why there is too little, as text; none if there is enough.
pub(super) fn too_little(needed_bytes: u64) -> Option<String> {
    let free = free_bytes()?;
    (free < needed_bytes).then(|| {
        format!(
            "{SHARED_MEMORY} has {} KiB free and {} KiB may be needed: delete files there, or \
             mount it with a larger size",
            free / 1_024,
            needed_bytes / 1_024
        )
    })
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
        assert!(too_little(u64::MAX).is_some());
    }
}
