//! `[recording]`: where flights are recorded.

use std::path::PathBuf;
use std::time::Duration;

use fcc_record::{Compression, RecorderSettings};
use serde::{Deserialize, Serialize};

/// `[recording]`.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct RecordingSection {
    /// Whether flights are recorded.
    pub enabled: bool,
    /// The folder for recordings; created if it is missing.
    pub folder: PathBuf,
    /// When a file reaches this size, a new one is begun; 0 for no limit.
    pub max_file_mb: u64,
    /// When a file covers this much of a flight, a new one is begun; 0 for no
    /// limit.
    pub max_file_minutes: u64,
    /// The oldest recordings are deleted to keep the total below this, and a
    /// file takes at most a quarter of it; 0 to delete none.
    pub keep_total_mb: u64,
    /// How they are compressed.
    pub compression: Compression,
}

impl Default for RecordingSection {
    fn default() -> Self {
        Self {
            enabled: true,
            folder: PathBuf::from("recordings"),
            max_file_mb: 1_000,
            max_file_minutes: 0,
            keep_total_mb: 0,
            compression: Compression::default(),
        }
    }
}

impl From<&RecordingSection> for RecorderSettings {
    fn from(section: &RecordingSection) -> Self {
        let limit = |value: u64| (value > 0).then_some(value);
        Self {
            max_file_bytes: limit(section.max_file_mb).map(|mb| mb * 1_000_000),
            max_file_age: limit(section.max_file_minutes)
                .map(|minutes| Duration::from_secs(minutes * 60)),
            keep_total_bytes: limit(section.keep_total_mb).map(|mb| mb * 1_000_000),
            compression: section.compression,
            ..Self::new(&section.folder)
        }
    }
}
