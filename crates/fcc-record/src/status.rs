//! The status of a recorder.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// The status of a recorder.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct RecorderStatus {
    /// The file being written, if any.
    pub file: Option<PathBuf>,
    /// Every file of this recording, in order, that was not lost since.
    pub files: Vec<PathBuf>,
    /// Records written, whether synced or not.
    pub ticks: u64,
    /// Bytes synced to the disk, all files together.
    pub bytes: u64,
    /// Records and events that were dropped because the disk was too slow or
    /// full.
    pub not_recorded: u64,
    /// Why nothing is recorded, and what is lost; none while recording works.
    pub stopped: Option<String>,
}

/// A message about a recording.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Notice {
    /// As text, for users.
    pub text: String,
    /// Whether something went wrong: a part of the flight is not recorded, or
    /// the file is not finished.
    pub is_trouble: bool,
}

/// The status shared by the recorder and its thread. Locked only to copy it,
/// and never by the loop's thread.
#[derive(Clone, Debug, Default)]
pub(super) struct Board(Arc<Mutex<RecorderStatus>>);

impl Board {
    pub(super) fn update(&self, change: impl FnOnce(&mut RecorderStatus)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }

    pub(super) fn read(&self) -> RecorderStatus {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}
