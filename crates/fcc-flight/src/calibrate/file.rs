//! The file of what was found: TOML below a first line with its checksum.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use fcc_telemetry::file_lock::try_lock;
use serde::{Deserialize, Serialize};

use super::Entry;
use crate::sealed::{self, Unsealed};

/// The beginning of every such file, a comment of TOML.
const NAME: &str = "# fccd-calibration";
/// The version of the layout.
const VERSION: u32 = 1;
/// A file has a hundredth of it.
const MOST_BYTES: u64 = 100_000;

/// Why a file cannot be used.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum CalibrationFileError {
    /// The system's error.
    #[error("cannot be read: {0}")]
    Unreadable(#[source] io::Error),
    /// It was written by something else; never overwritten.
    #[error("was not written by fccd calibrate: choose another calibration.file")]
    Foreign,
    /// It is of another version.
    #[error(
        "is of another version of fccd ({0}, and this one reads {VERSION}): remove it, and calibrate again"
    )]
    Version(u32),
    /// It was damaged, or edited; there may be a copy of the one before.
    #[error(
        "is damaged, or was edited: {}remove it and calibrate again; values of your own belong \
         into the configuration's calibration",
        .0.as_ref().map_or_else(String::new, |copy| format!("put back {}, or ", copy.display()))
    )]
    Damaged(Option<PathBuf>),
    /// A value cannot be used.
    #[error("cannot be used: {0}; remove it, and calibrate again")]
    Unusable(String),
    /// It cannot be written.
    #[error("cannot be written: {0}")]
    Unwritable(#[source] io::Error),
    /// Another program changes it.
    #[error("another fccd calibrate stores in it: wait until that one has ended")]
    Locked,
}

impl From<Unsealed> for CalibrationFileError {
    fn from(unsealed: Unsealed) -> Self {
        match unsealed {
            Unsealed::Foreign => Self::Foreign,
            Unsealed::Version(version) => Self::Version(version),
            Unsealed::Damaged => Self::Damaged(None),
        }
    }
}

/// All that was found.
#[derive(Clone, PartialEq, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CalibrationFile {
    /// At most one for each kind and place.
    #[serde(default)]
    pub calibration: Vec<Entry>,
}

impl CalibrationFile {
    /// Reads a file; nothing was found if it does not exist.
    ///
    /// # Errors
    /// When it cannot be read, is damaged, or was not written by this program.
    pub fn read(path: &Path) -> Result<Self, CalibrationFileError> {
        match fcc_record::read_own_file(path, MOST_BYTES) {
            Ok(bytes) => Self::decode(&bytes).map_err(|error| match error {
                CalibrationFileError::Damaged(_) => {
                    let copy = backup(path);
                    CalibrationFileError::Damaged(copy.exists().then_some(copy))
                }
                other => other,
            }),
            // Without its folder it does not exist either; who writes there says so.
            Err(error)
                if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) =>
            {
                Ok(Self::default())
            }
            Err(error) => Err(CalibrationFileError::Unreadable(error)),
        }
    }

    fn decode(bytes: &[u8]) -> Result<Self, CalibrationFileError> {
        let body = sealed::open(NAME, VERSION, bytes)?;
        let text = std::str::from_utf8(body).map_err(|_| CalibrationFileError::Damaged(None))?;
        toml::from_str(text).map_err(|_| CalibrationFileError::Damaged(None))
    }
}

/// The file, locked against other programs until this is dropped.
#[derive(Debug)]
pub struct LockedCalibrationFile {
    content: CalibrationFile,
    path: PathBuf,
    _lock: File,
}

impl LockedCalibrationFile {
    /// Locks a file and reads it; its folder is created if it is missing.
    ///
    /// # Errors
    /// As [`CalibrationFile::read`], or when nothing can be written in its folder,
    /// or another program has locked it.
    pub fn open(path: PathBuf) -> Result<Self, CalibrationFileError> {
        if let Some(folder) = path.parent()
            && !folder.as_os_str().is_empty()
        {
            fcc_record::create_folder(folder).map_err(CalibrationFileError::Unwritable)?;
        }
        let lock = fcc_record::open_lock(&path.with_extension("lock"))
            .map_err(CalibrationFileError::Unwritable)?;
        // Not every file system has locks.
        if !try_lock(&lock).unwrap_or(true) {
            return Err(CalibrationFileError::Locked);
        }
        Ok(Self {
            content: CalibrationFile::read(&path)?,
            path,
            _lock: lock,
        })
    }

    /// Adds what was found, instead of what was found before of the same, and
    /// writes the file. The old one is kept beside it, with the extension
    /// `old.toml`.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn add(&mut self, entry: Entry) -> Result<(), CalibrationFileError> {
        let is_other = |old: &Entry| (old.kind, &old.place) != (entry.kind, &entry.place);
        self.content.calibration.retain(is_other);
        self.content.calibration.push(entry);
        self.write().map_err(CalibrationFileError::Unwritable)
    }

    fn write(&self) -> io::Result<()> {
        match fcc_record::read_own_file(&self.path, MOST_BYTES) {
            Ok(old) => sealed::replace(&backup(&self.path), "old.new", &old)?,
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(error),
        }
        let body = toml::to_string(&self.content).map_err(io::Error::other)?;
        let bytes = sealed::seal(NAME, VERSION, body.as_bytes());
        sealed::replace(&self.path, "toml.new", &bytes)
    }
}

/// `fccd.calibration.toml` becomes `fccd.calibration.old.toml`.
fn backup(path: &Path) -> PathBuf {
    path.with_extension("old.toml")
}

/// Whether what a file with this body contains is written so that it is read
/// again; `None` if it is refused.
#[cfg(fuzzing)]
pub fn read_calibration(body: &[u8]) -> Option<bool> {
    let _ = CalibrationFile::decode(body);
    let read = CalibrationFile::decode(&sealed::seal(NAME, VERSION, body)).ok()?;
    let again = sealed::seal(NAME, VERSION, toml::to_string(&read).ok()?.as_bytes());
    Some(CalibrationFile::decode(&again).is_ok())
}
