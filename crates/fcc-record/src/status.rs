//! How a recorder does, for whoever looks.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// How a recorder does.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct RecorderStatus {
    /// The file being written; none while nothing is.
    pub file: Option<PathBuf>,
    /// Every file of this recording, in order.
    pub files: Vec<PathBuf>,
    /// Records written, whether synced already or not.
    pub ticks: u64,
    /// Bytes that are safe on the disk, all files together.
    pub bytes: u64,
    /// Records and events that were dropped: the disk was too slow or full.
    pub not_recorded: u64,
    /// Why nothing is recorded, and what is lost by it; none while the disk
    /// takes what it is given.
    pub stopped: Option<String>,
}

/// Something to say about a recording.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct News {
    /// In words for people.
    pub text: String,
    /// Whether something went wrong: a part of the flight is not recorded, or
    /// not as it should be.
    pub is_trouble: bool,
}

/// Where a recorder's thread leaves its status. Only ever locked for a copy,
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
