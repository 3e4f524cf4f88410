//! Where recordings are written: a file system, or a test's idea of a bad one.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

/// Where recordings are written.
pub trait Disk: Send {
    /// Makes a file that does not exist yet.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if it does; else what the system says.
    fn create(&mut self, path: &Path) -> io::Result<Box<dyn DiskFile>>;
}

/// A file being written.
pub trait DiskFile: Write {
    /// Waits until everything written is safe from a loss of power.
    ///
    /// # Errors
    /// What the system says.
    fn sync(&mut self) -> io::Result<()>;

    /// Cuts the file off after so many bytes; what is written next follows
    /// there.
    ///
    /// # Errors
    /// What the system says.
    fn cut_to(&mut self, bytes: u64) -> io::Result<()>;
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
            fs::create_dir_all(folder).map_err(|error| match error.kind() {
                // It is not this file that exists.
                io::ErrorKind::AlreadyExists => io::ErrorKind::NotADirectory.into(),
                _ => error,
            })?;
        }
        // Readable, for the lock: it tells others that this one is being
        // written. A file system without locks does without.
        let file = OpenOptions::new()
            .read(true)
            .append(true)
            .create_new(true)
            .open(path)?;
        let _ = file.try_lock();
        // Until its folder is synced, a loss of power takes the file's name.
        match sync_folder_of(path) {
            Ok(()) => Ok(Box::new(file)),
            Err(error) => {
                // It would be in the way of the next attempt.
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
}

/// Waits until the name of a file is safe from a loss of power. A file system
/// that knows no such thing does without.
pub(super) fn sync_folder_of(path: &Path) -> io::Result<()> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    match File::open(folder.unwrap_or(Path::new(".")))?.sync_all() {
        Err(error) if error.kind() == io::ErrorKind::InvalidInput => Ok(()),
        done => done,
    }
}

/// Opens a file to read it. A FIFO or a device is refused: opening one may wait
/// for ever.
pub(super) fn open(path: &Path) -> io::Result<File> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is not a regular file: give a recording, a file that ends in .mcap",
        ));
    }
    File::open(path)
}

/// Keeps others from writing a file until what comes back is dropped; none if
/// somebody does. A file system without locks does without.
pub(super) fn lock(path: &Path) -> io::Result<Option<File>> {
    let file = open(path)?;
    let is_taken = matches!(file.try_lock(), Err(fs::TryLockError::WouldBlock));
    Ok((!is_taken).then_some(file))
}

/// Whether somebody is writing a file right now.
pub fn is_being_written(path: &Path) -> bool {
    open(path).is_ok_and(|file| matches!(file.try_lock_shared(), Err(fs::TryLockError::WouldBlock)))
}
