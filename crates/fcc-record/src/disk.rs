//! Where recordings are written: a file system, or a failing disk in a test.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _};
use std::path::Path;

use super::opening::{RECORDING, create_folder, open, open_found, open_to_lock};
use fcc_telemetry::file_lock::{is_locked, try_lock};

/// Where recordings are written.
pub trait Disk: Send {
    /// Creates a file that does not exist yet.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if it exists; otherwise the system's
    /// error.
    fn create(&mut self, path: &Path) -> io::Result<Box<dyn DiskFile>>;
}

/// A file being written.
pub trait DiskFile: Write {
    /// Waits until everything written survives a loss of power.
    ///
    /// # Errors
    /// The system's error.
    fn sync(&mut self) -> io::Result<()>;

    /// Truncates the file to a length; the next write continues there.
    ///
    /// # Errors
    /// The system's error.
    fn cut_to(&mut self, bytes: u64) -> io::Result<()>;

    /// What another program did to the file at `path`, of which `bytes` were
    /// written: deleted, replaced or truncated it. None if nothing is known.
    fn change(&self, path: &Path, bytes: u64) -> Option<String> {
        let _ = (path, bytes);
        None
    }
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct FileSystem;

impl Disk for FileSystem {
    fn create(&mut self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder {
            create_folder(folder)?;
        }
        // Locked, so that others know that it is being written. Not every file
        // system has locks.
        let file = OpenOptions::new()
            .read(true)
            .append(true)
            .create_new(true)
            .mode(RECORDING)
            .open(path)?;
        let _ = try_lock(&file);
        // Until its folder is synced, a loss of power removes the file's name.
        match sync_folder_of(path) {
            Ok(()) => Ok(Box::new(file)),
            Err(error) => {
                // It would block the next attempt.
                let _ = fs::remove_file(path);
                Err(error)
            }
        }
    }
}

impl DiskFile for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }

    fn cut_to(&mut self, bytes: u64) -> io::Result<()> {
        self.set_len(bytes)
    }

    fn change(&self, path: &Path, bytes: u64) -> Option<String> {
        let own = self.metadata().ok()?;
        if own.len() != bytes {
            let now = own.len();
            let what = format!("was truncated or changed ({now} bytes instead of {bytes})");
            return Some(what);
        }
        match fs::metadata(path) {
            Ok(there) if (there.dev(), there.ino()) == (own.dev(), own.ino()) => None,
            Ok(_) => Some("was replaced by another file".to_owned()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Some("was deleted or renamed".to_owned())
            }
            Err(_) => None,
        }
    }
}

/// Waits until the name of a file survives a loss of power. Not every file
/// system supports this.
pub(super) fn sync_folder_of(path: &Path) -> io::Result<()> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    match File::open(folder.unwrap_or(Path::new(".")))?.sync_all() {
        Err(error) if error.kind() == io::ErrorKind::InvalidInput => Ok(()),
        done => done,
    }
}

/// What writing gave; a reader that has left, as in `| head`, is no failure.
///
/// # Errors
/// Those of writing, other than a closed pipe.
pub fn unless_left(written: io::Result<()>) -> io::Result<()> {
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// Whether both names lead to one file, also over a link.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    let identity = |path| fs::metadata(path).map(|file| (file.dev(), file.ino()));
    identity(one).is_ok_and(|one| identity(other).is_ok_and(|other| other == one))
}

/// Locks a file against other writers until the returned value is dropped; none
/// if it is locked already. Not every file system has locks.
pub(super) fn lock(path: &Path) -> io::Result<Option<File>> {
    let file = open_to_lock(path)?;
    let is_free = try_lock(&file).unwrap_or(true);
    Ok(is_free.then_some(file))
}

/// Whether a program is writing the file now.
pub(super) fn is_being_written(path: &Path) -> bool {
    open(path).is_ok_and(|file| is_locked(&file))
}

/// As [`is_being_written`], of a file that was found in a folder. What cannot be
/// opened, such as a link, is none of this program's files.
pub(super) fn may_be_deleted(path: &Path) -> bool {
    open_found(path).is_ok_and(|file| !is_locked(&file))
}
