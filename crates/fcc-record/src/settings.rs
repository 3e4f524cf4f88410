//! How and where a recorder writes.

use std::path::PathBuf;
use std::time::Duration;

/// How and where a recorder writes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RecorderSettings {
    /// Where recordings go; made if it is missing.
    pub folder: PathBuf,
    /// A file that has grown to this size is finished and another begun; none
    /// for no limit.
    pub max_file_bytes: Option<u64>,
    /// A file that covers this much of a flight is finished and another begun;
    /// none for no limit.
    pub max_file_age: Option<Duration>,
    /// Keep the folder's recordings below this: the oldest are deleted, when a
    /// file is begun, as it grows, and when the disk is full. None never
    /// deletes.
    pub keep_total_bytes: Option<u64>,
    /// How chunks are compressed.
    pub compression: Compression,
    /// What happens to what the disk is too slow for.
    pub pace: RecordingPace,
    /// How many messages may wait for the disk.
    pub capacity: usize,
    /// How long after a disk has failed a new file is tried, again and again
    /// until the flight ends.
    pub retry_every: Duration,
}

impl RecorderSettings {
    /// Records into a folder, without any limit, in real time.
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

/// Soon enough for a disk that somebody makes room on, seldom enough for one
/// that stays full.
const DEFAULT_RETRY_EVERY: Duration = Duration::from_secs(10);

/// What happens to what the disk is too slow for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RecordingPace {
    /// It is dropped and counted: nobody ever waits for a disk.
    RealTime,
    /// Who records waits: for flights in lockstep, which have no real time.
    Lockstep,
}

/// How the chunks of a recording are compressed.
///
/// Measured with the built-in aircraft and its sensors' noise, which is most
/// of what there is to compress; CPU is that of the recorder's thread, in
/// percent of one core of a 2.x GHz server (a Raspberry Pi 3's is some eight
/// times slower):
///
/// | | bytes per tick, 40 Hz | 1 kHz | CPU, 40 Hz | 1 kHz |
/// |---|---|---|---|---|
/// | none | 790 | 560 | 0.15 % | 0.25 % |
/// | lz4 | 520 | 370 | 0.17 % | 0.39 % |
/// | zstd | 460 | 310 | 0.23 % | 0.67 % |
///
/// Encoding alone is what "none" costs. The default is zstd: its price is
/// small beside the fifth of a disk that it saves.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
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
