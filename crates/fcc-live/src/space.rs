//! Whether there is room in the system's shared memory.

use std::path::Path;

use nix::sys::statvfs::statvfs;

/// Where Linux keeps shared memory.
pub(super) const SHARED_MEMORY: &str = "/dev/shm";

/// Room that publishing may need at any time: all records, events and watchers'
/// connections there can be come to some 3 MiB.
pub(super) const NEEDED_BYTES: u64 = 8 * 1_024 * 1_024;

/// Below this, nothing is published until there is room again. A page of shared
/// memory that cannot be had kills the process that touches it: a full
/// `/dev/shm` must never end a flight.
pub(super) const LEAST_BYTES: u64 = 4 * 1_024 * 1_024;

/// What a watcher needs for its connections, with room to spare.
pub(super) const WATCHER_BYTES: u64 = 1_024 * 1_024;

/// Free shared memory; none where it is not known, which is no reason to stop.
pub(super) fn free_bytes() -> Option<u64> {
    free_at(Path::new(SHARED_MEMORY))
}

fn free_at(folder: &Path) -> Option<u64> {
    let space = statvfs(folder).ok()?;
    // A file system without a limit says 0 blocks.
    (space.blocks() > 0)
        .then(|| (space.blocks_available() as u64).saturating_mul(space.fragment_size() as u64))
}

/// Why there is too little, in words; none if there is enough.
pub(super) fn too_little(needed_bytes: u64) -> Option<String> {
    let free = free_bytes()?;
    (free < needed_bytes).then(|| {
        format!(
            "{SHARED_MEMORY} has {} KiB free and {} KiB may be needed: remove what fills it, or \
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
    fn an_unknown_place_is_no_reason_to_stop() {
        assert_eq!(free_at(Path::new("/no/such/folder")), None);
    }

    #[test]
    fn nobody_has_all_the_memory_there_is() {
        assert!(too_little(u64::MAX).is_some());
    }
}
