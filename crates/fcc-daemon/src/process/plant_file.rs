//! The file of a plant: the lock of the daemon that may control it, and whether
//! a daemon holds, or has left held, its controls.
//!
//! It contains two numbers: that of the last takeover, and that of the takeover
//! whose release was confirmed. They differ while the controls are held. A
//! daemon that is killed leaves the file, and the lock to the next.

use std::fs::{self, File, TryLockError};
use std::io;
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fcc_core::framework::{ControlAuthority, PlantId};
use fcc_flight::config::Config;
use fcc_flight::flight::authority_without_connection;
use fcc_telemetry::RunFolder;

use crate::output;

/// Where the two numbers are in the file, each 8 bytes, little-endian.
const TAKEN_AT: u64 = 0;
const RELEASED_AT: u64 = 8;

/// The name of a plant's file. A plant at a loopback address is another one in
/// each network namespace.
pub(super) fn name(plant: &PlantId) -> String {
    let namespace = fs::metadata("/proc/self/ns/net").map_or(0, |found| found.ino());
    let plant = plant.as_str().replace(['/', '\0'], "_");
    format!("{plant} in {namespace}")
}

/// The file of a plant.
#[derive(Debug)]
pub(super) struct PlantFile {
    path: PathBuf,
    file: File,
}

impl PlantFile {
    /// Opens the file; creates it if it is missing.
    pub(super) fn open(folder: &RunFolder, plant: &PlantId) -> io::Result<Self> {
        let name = name(plant);
        Ok(Self {
            path: folder.path(&name),
            file: folder.open(&name)?,
        })
    }

    /// Opens and locks the file; none if another daemon has locked it.
    pub(super) fn locked(folder: &RunFolder, plant: &PlantId) -> io::Result<Option<Self>> {
        loop {
            let this = Self::open(folder, plant)?;
            match this.file.try_lock() {
                Ok(()) if this.is_in_place() => return Ok(Some(this)),
                // Removed by the daemon that had locked it.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Ok(None),
                Err(TryLockError::Error(error)) => return Err(error),
            }
        }
    }

    /// Whether the file is still where the next daemon looks for it.
    pub(super) fn is_in_place(&self) -> bool {
        is_in_place(&self.file, &self.path)
    }

    fn number(&self, at: u64) -> u64 {
        let mut bytes = [0; 8];
        match self.file.read_exact_at(&mut bytes, at) {
            Ok(()) => u64::from_le_bytes(bytes),
            Err(_) => 0,
        }
    }

    /// Writes the two numbers as they are: what is stored later needs no new
    /// space.
    pub(super) fn reserve(&self) -> io::Result<()> {
        let numbers = [TAKEN_AT, RELEASED_AT].map(|at| self.number(at).to_le_bytes());
        self.file.write_all_at(numbers.as_flattened(), TAKEN_AT)
    }

    /// The number of the last takeover.
    pub(super) fn taken(&self) -> u64 {
        self.number(TAKEN_AT)
    }

    /// Whether the controls are held, or were left held.
    pub(super) fn is_held(&self) -> bool {
        self.taken() != self.number(RELEASED_AT)
    }

    /// Stores that control is taken.
    pub(super) fn take(&self, number: u64) {
        // In one call, and held whatever the file contained before.
        let numbers = [number, number.wrapping_sub(1)].map(u64::to_le_bytes);
        // Without the file, the release helper knows.
        let _ = self.file.write_all_at(numbers.as_flattened(), TAKEN_AT);
    }

    /// Stores that the release after this takeover is confirmed, if it is the
    /// last one.
    pub(super) fn release(&self, number: u64) {
        if self.taken() == number {
            let _ = self.file.write_all_at(&number.to_le_bytes(), RELEASED_AT);
        }
    }

    /// Replaces its content, as another program of the user could.
    #[cfg(any(test, fuzzing))]
    pub(super) fn contain(&self, content: &[u8]) -> io::Result<()> {
        self.file.set_len(0)?;
        self.file.write_all_at(content, 0)
    }

    /// Removes the file, unless another daemon has locked it, or it is needed
    /// at the next start.
    pub(super) fn remove_if_released(&self) {
        if self.file.try_lock().is_ok() && !self.is_held() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Whether another daemon may control this plant of a configuration.
pub(crate) fn is_flown(config: &Config, plant: &PlantId) -> bool {
    let folder = RunFolder::of_this_process(&mut |why| output::message(why));
    let Some((authority, folder)) = authority_without_connection(config).zip(folder) else {
        return false;
    };
    match PlantFile::locked(&folder, &authority.unique(plant)) {
        Ok(Some(file)) => {
            file.remove_if_released();
            false
        }
        Ok(None) => true,
        Err(_) => false,
    }
}

/// Marks a plant as held for the next daemon, of a program without a loop.
pub(crate) struct Mark {
    authority: Option<Arc<dyn ControlAuthority>>,
    folder: Option<RunFolder>,
    /// Not if the daemon that it has started flies the plant in between.
    locks: bool,
    file: Option<PlantFile>,
}

impl Mark {
    /// For the plant of this configuration; whether it `locks` the plant, too.
    pub(crate) fn of(config: &Config, locks: bool) -> Self {
        Self {
            authority: authority_without_connection(config),
            folder: RunFolder::of_this_process(&mut |why| output::message(why)),
            locks,
            file: None,
        }
    }

    /// Control of this plant is to be taken, with this number as the release helper
    /// will know it. Returns whether no other daemon has it.
    pub(crate) fn set(&mut self, plant: &PlantId, number: u64) -> bool {
        let Some((authority, folder)) = self.authority.as_ref().zip(self.folder.as_ref()) else {
            return true;
        };
        let unique = authority.unique(plant);
        // Anew each time: a daemon may have removed the file since.
        let opened = if self.locks {
            PlantFile::locked(folder, &unique)
        } else {
            PlantFile::open(folder, &unique).map(Some)
        };
        self.file = match opened {
            Ok(Some(file)) => Some(file),
            Ok(None) => return false,
            // As a daemon without a lock flies.
            Err(_) => None,
        };
        if let Some(file) = &self.file {
            file.take(number);
        }
        true
    }

    /// Its release is confirmed.
    pub(crate) fn remove(&mut self, number: u64) {
        if let Some(file) = self.file.take() {
            file.release(number);
            file.remove_if_released();
        }
    }
}

/// Whether this open file is the one of this name.
pub(super) fn is_in_place(file: &File, path: &Path) -> bool {
    let [ours, there] = [file.metadata(), fs::symlink_metadata(path)]
        .map(|found| found.map(|found| (found.dev(), found.ino())).ok());
    ours.is_some() && ours == there
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::TakeoverNotice as _;

    use super::super::Notice;
    use super::*;

    fn plant(which: &str) -> PlantId {
        PlantId::new(format_args!("{which} of a/test")).unwrap()
    }

    /// Another program of the user may have written anything.
    #[test]
    fn what_is_taken_is_held_whatever_the_file_contained() {
        let (_root, folder) = folder();
        // Numbers of a takeover and of a later release; the largest; half of one.
        for content in [
            [4_u64, 5].map(u64::to_le_bytes).as_flattened(),
            &[255; 8],
            &[7; 12],
        ] {
            let open = || PlantFile::open(&folder, &plant("one")).unwrap();
            open().contain(content).unwrap();
            let notice = Notice::default();
            notice.add_file(plant("one"), open());
            notice.taking(&plant("one"));
            assert!(open().is_held(), "{content:?}");
            notice.release(notice.number());
            assert!(!open().is_held(), "{content:?}");
        }
    }

    #[test]
    fn what_is_reserved_means_the_same() {
        let (_root, folder) = folder();
        let open = || PlantFile::open(&folder, &plant("one")).unwrap();
        for content in [&[][..], &[7; 3], &[255; 8], &[7; 12], &[7; 16], &[3; 40]] {
            open().contain(content).unwrap();
            let before = (open().taken(), open().is_held());
            open().reserve().unwrap();
            assert_eq!((open().taken(), open().is_held()), before, "{content:?}");
            assert!(open().file.metadata().unwrap().len() >= 16);
        }
    }

    /// A folder of this user, removed with the returned value.
    fn folder() -> (tempfile::TempDir, RunFolder) {
        let root = tempfile::tempdir().unwrap();
        let folder = RunFolder::at(root.path().join("fccd")).unwrap();
        (root, folder)
    }

    #[test]
    fn a_plant_is_locked_once_and_unlocked() {
        let (_root, folder) = folder();
        let lock = |which| PlantFile::locked(&folder, &plant(which)).unwrap();
        let first = lock("one").unwrap();
        assert!(lock("one").is_none());
        assert!(lock("another").is_some());
        first.remove_if_released();
        drop(first);
        assert!(lock("one").is_some());
    }

    #[test]
    fn what_is_held_is_found_by_the_next_and_only_the_last_release_counts() {
        let (_root, folder) = folder();
        let open = || PlantFile::open(&folder, &plant("one")).unwrap();
        assert!(!open().is_held());
        open().take(3);
        open().remove_if_released();
        assert_eq!(open().taken(), 3);
        assert!(open().is_held());
        open().take(4);
        open().release(3);
        assert!(open().is_held());
        open().release(4);
        assert!(!open().is_held());
        open().remove_if_released();
        assert_eq!(open().taken(), 0, "a new file");
    }
}
