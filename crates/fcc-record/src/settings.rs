//! Where and how a recorder writes.

use std::path::PathBuf;
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// Where and how a recorder writes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RecorderSettings {
    /// The folder of the recordings; created if it is missing.
    pub folder: PathBuf,
    /// A file that reaches this size is finished and the next begun; none for
    /// no limit.
    pub max_file_bytes: Option<u64>,
    /// A file that covers this duration is finished and the next begun; none
    /// for no limit.
    pub max_file_age: Option<Duration>,
    /// Keep the folder's recordings below this size: the oldest are deleted
    /// when a file is begun, while it grows, and when the disk is full, but no
    /// file of the flight in progress. A file takes at most a quarter of it. None
    /// never deletes.
    pub keep_total_bytes: Option<u64>,
    /// How chunks are compressed.
    pub compression: Compression,
    /// What happens when the disk is too slow.
    pub pace: RecordingPace,
    /// The number of messages that may wait for the disk.
    pub capacity: usize,
    /// Time between attempts to begin a new file after the disk failed.
    pub retry_every: Duration,
}

impl RecorderSettings {
    /// Records into a folder, without limits, in real time.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
            max_file_bytes: None,
            max_file_age: None,
            keep_total_bytes: None,
            compression: Compression::default(),
            pace: RecordingPace::RealTime,
            capacity: DEFAULT_CAPACITY,
            retry_every: DEFAULT_RETRY_EVERY,
        }
    }
}

/// 8 s at 1 kHz, 200 s at 40 Hz, and 4 MiB.
const DEFAULT_CAPACITY: usize = 8_192;

/// Soon enough after room is made on a disk, seldom enough for one that stays
/// full.
const DEFAULT_RETRY_EVERY: Duration = Duration::from_secs(10);

/// What happens when the disk is too slow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RecordingPace {
    /// Messages are dropped and counted: the flight never waits for a disk.
    RealTime,
    /// The flight waits for the disk: for lockstep, which has no real time.
    Lockstep,
}

/// How the chunks of a recording are compressed.
///
/// Measured with the built-in aircraft and its sensors' noise, which is most of
/// the data; CPU is that of the recorder's thread, in percent of one core of a
/// 2.x GHz server (a Raspberry Pi 3's is some eight times slower):
///
/// | | bytes per tick, 40 Hz | 1 kHz | CPU, 40 Hz | 1 kHz |
/// |---|---|---|---|---|
/// | none | 790 | 560 | 0.15 % | 0.25 % |
/// | lz4 | 520 | 370 | 0.17 % | 0.39 % |
/// | zstd | 460 | 310 | 0.23 % | 0.67 % |
///
/// "None" is the cost of encoding alone. The default is zstd: it costs little
/// and saves a fifth of the disk.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Compression {
    /// Not at all.
    None,
    /// Fast.
    Lz4,
    /// Small.
    #[default]
    Zstd,
}

impl Compression {
    pub(super) const fn to_mcap(self) -> Option<mcap::Compression> {
        match self {
            Self::None => None,
            Self::Lz4 => Some(mcap::Compression::Lz4),
            Self::Zstd => Some(mcap::Compression::Zstd),
        }
    }
}
