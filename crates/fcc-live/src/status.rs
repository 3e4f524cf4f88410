//! The status of a run, each second.

use serde::{Deserialize, Serialize};

use super::{LatenessCounts, Text};

/// The status of a run, published each second.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[repr(C)]
pub struct Status {
    /// Wake-up of the last tick, ns on the loop's clock.
    pub time_ns: i64,
    /// Ticks since the loop's start.
    pub ticks: u64,
    /// Missed periods since the loop's start.
    pub missed: u64,
    /// Lateness that half of all ticks did not exceed, ns.
    pub lateness_p50_ns: u64,
    /// Lateness that 99 % did not exceed, ns.
    pub lateness_p99_ns: u64,
    /// Lateness that 99.9 % did not exceed, ns.
    pub lateness_p99_9_ns: u64,
    /// The greatest lateness, ns.
    pub lateness_max_ns: u64,
    /// Ticks by lateness.
    pub lateness_counts: LatenessCounts,
    /// Records that were not published: the telemetry thread was delayed, or
    /// shared memory was full.
    pub not_published: u64,
    /// CPU time that the telemetry thread has used, ns.
    pub cpu_ns: u64,
    /// Programs that watch the records.
    pub watchers: u32,
    /// See [`RecorderState`].
    pub recorder_state: u32,
    /// Records in the file.
    pub recorded: u64,
    /// Records that are not in the file.
    pub not_recorded: u64,
    /// Size of the file.
    pub recording_bytes: u64,
    /// The file's name, or why there is none.
    pub recording: Text<128>,
}

/// What the recorder is doing.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[repr(u32)]
pub enum RecorderState {
    /// Recording is off.
    #[default]
    Off = 0,
    /// Writing.
    Recording = 1,
    /// Cannot write: the disk is full, or the folder is read-only.
    Stopped = 2,
}

/// The recorder's state and figures.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[repr(C)]
pub struct RecorderStatus {
    /// Its state.
    pub state: RecorderState,
    /// Records in the file.
    pub recorded: u64,
    /// Records that are not in the file.
    pub not_recorded: u64,
    /// Size of the file.
    pub bytes: u64,
    /// The file's name, or why there is none.
    pub name: Text<128>,
}

impl Status {
    /// The recorder's state; off if the number is unknown.
    pub fn recorder(&self) -> RecorderState {
        match self.recorder_state {
            1 => RecorderState::Recording,
            2 => RecorderState::Stopped,
            _ => RecorderState::Off,
        }
    }
}
