//! Notices that files were removed, replaced or written by another program.

use std::fs::{self, File, Metadata};
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};

use super::place::entries;
use fcc_telemetry::RunFolder;

/// The marks of a set of files.
#[derive(Default, Debug)]
pub(super) struct Marks(Vec<Marked>);

#[derive(Debug)]
struct Marked {
    path: PathBuf,
    mark: Mark,
    mapped: Option<Mapped>,
}

/// A file that programs map and write. iceoryx2 begins it with its version, once.
/// Who overwrites it through a mapping changes nothing else that can be seen
/// without reading all of it.
#[derive(Debug)]
struct Mapped {
    file: File,
    begins: [u8; BEGINNING_BYTES],
}

const BEGINNING_BYTES: usize = 8;

/// Changes when a file is replaced, cut off or extended, when its mode changes,
/// and when one that nobody should write is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Mark {
    inode: u64,
    bytes: u64,
    mode: u32,
    /// Of the last change; 0 for files that programs map and write.
    changed: (i64, i64),
}

impl Mark {
    fn of(found: &Metadata) -> Self {
        let is_read_only = found.mode() & 0o222 == 0;
        let changed = (found.mtime(), found.mtime_nsec());
        Self {
            inode: found.ino(),
            bytes: found.size(),
            mode: found.mode(),
            changed: if is_read_only { changed } else { (0, 0) },
        }
    }
}

impl Marked {
    fn of(path: PathBuf) -> Option<Self> {
        let found = fs::symlink_metadata(&path).ok()?;
        found.is_file().then(|| Self {
            mark: Mark::of(&found),
            mapped: Mapped::of(&path, &found),
            path,
        })
    }

    fn differs(&self) -> bool {
        let found = fs::symlink_metadata(&self.path);
        found.map_or(true, |found| Mark::of(&found) != self.mark)
            || self.mapped.as_ref().is_some_and(Mapped::differs)
    }
}

impl Mapped {
    /// None of a file that is empty: it is locked by its process, and a process
    /// that closes it unlocks it (fcntl(2)).
    fn of(path: &Path, found: &Metadata) -> Option<Self> {
        if found.mode() & 0o222 == 0 || found.size() == 0 {
            return None;
        }
        let file = File::open(path).ok()?;
        Some(Self {
            begins: beginning(&file),
            file,
        })
    }

    fn differs(&self) -> bool {
        beginning(&self.file) != self.begins
    }
}

/// Zeros in place of what a shorter file lacks. Read, not mapped: a file that is
/// cut off meanwhile does no harm.
fn beginning(file: &File) -> [u8; BEGINNING_BYTES] {
    let mut bytes = [0; BEGINNING_BYTES];
    let _ = file.read_at(&mut bytes, 0);
    bytes
}

impl Marks {
    /// Of all files that are now in a folder and in those in it.
    pub(super) fn of(folder: &RunFolder) -> Self {
        let outer: Vec<_> = entries(folder.as_path()).collect();
        let inner = outer.iter().flat_map(|path| entries(path));
        let files = outer.iter().cloned().chain(inner);
        Self(files.filter_map(Marked::of).collect())
    }

    /// Whether a file is no longer as it was.
    pub(super) fn differ(&self) -> bool {
        self.0.iter().any(Marked::differs)
    }
}

#[cfg(test)]
mod tests {
    use std::fs::Permissions;
    use std::os::unix::fs::PermissionsExt;
    use std::time::{Duration, SystemTime};

    use super::*;

    #[test]
    fn what_is_removed_cut_off_or_made_accessible_differs() {
        let root = tempfile::tempdir().unwrap();
        let folder = RunFolder::at(root.path().join("run")).unwrap();
        let path = folder.inside("inner").unwrap().path("file");
        fs::write(&path, "words").unwrap();
        let before = || {
            let marks = Marks::of(&folder);
            assert!(marks.0.len() == 1 && !marks.differ());
            marks
        };
        // Of the same length: watchers write as well, but not the version.
        fs::write(&path, "version.words").unwrap();
        let marks = before();
        fs::write(&path, "version.other").unwrap();
        assert!(!marks.differ());
        fs::write(&path, "another.other").unwrap();
        assert!(marks.differ());
        let marks = before();
        fs::write(&path, "another").unwrap();
        assert!(marks.differ());
        let marks = before();
        fs::set_permissions(&path, Permissions::from_mode(0o400)).unwrap();
        assert!(marks.differ());
        // Nobody writes one that is only read.
        let marks = before();
        let later = SystemTime::now() + Duration::from_secs(1);
        File::open(&path).unwrap().set_modified(later).unwrap();
        assert!(marks.differ());
        let marks = before();
        fs::remove_file(&path).unwrap();
        assert!(marks.differ());
    }
}
