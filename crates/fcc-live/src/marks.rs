//! Notices that files were removed, replaced or written by another program.

use std::fs::{self, Metadata};
use std::os::unix::fs::MetadataExt;
use std::path::PathBuf;

use super::place::entries;
use fcc_telemetry::RunFolder;

/// The marks of a set of files.
#[derive(Default, Debug)]
pub(super) struct Marks(Vec<(PathBuf, Mark)>);

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

impl Marks {
    /// Of all files that are now in a folder and in those in it.
    pub(super) fn of(folder: &RunFolder) -> Self {
        let outer: Vec<_> = entries(folder.as_path()).collect();
        let inner = outer.iter().flat_map(|path| entries(path));
        let files = outer.iter().cloned().chain(inner).filter_map(|path| {
            let found = fs::symlink_metadata(&path).ok()?;
            found.is_file().then(|| (path, Mark::of(&found)))
        });
        Self(files.collect())
    }

    /// Whether a file is no longer as it was.
    pub(super) fn differ(&self) -> bool {
        self.0.iter().any(|(path, mark)| {
            fs::symlink_metadata(path).map_or(true, |found| Mark::of(&found) != *mark)
        })
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
        // Of the same length: watchers write as well.
        let marks = before();
        fs::write(&path, "other").unwrap();
        assert!(!marks.differ());
        fs::write(&path, "w").unwrap();
        assert!(marks.differ());
        let marks = before();
        fs::set_permissions(&path, Permissions::from_mode(0o400)).unwrap();
        assert!(marks.differ());
        // Nobody writes one that is only read.
        let marks = before();
        let later = SystemTime::now() + Duration::from_secs(1);
        fs::File::open(&path).unwrap().set_modified(later).unwrap();
        assert!(marks.differ());
        let marks = before();
        fs::remove_file(&path).unwrap();
        assert!(marks.differ());
    }
}
