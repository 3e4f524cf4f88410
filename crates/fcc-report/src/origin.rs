//! The origin of a recording.

use serde::Serialize;

use fcc_record::{About, Recording};
use fcc_telemetry::Realtime;

/// The origin of a recording. Unknown texts are empty.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct Origin {
    /// File of the recording.
    pub file: String,
    /// Start, in UTC.
    pub started: String,
    /// The aircraft.
    pub plant: String,
    /// The program that recorded.
    pub software: String,
    /// The commit it was built from.
    pub git_hash: String,
    /// SHA-256 of the configuration.
    pub config_sha256: String,
    /// The machine.
    pub host: String,
    /// Its kernel.
    pub kernel: String,
    /// The timer of the loop.
    pub timer: String,
    /// Scheduling of the loop's thread.
    pub realtime: Realtime,
    /// Names of the sensors, in the order of the loop.
    pub sensors: Vec<String>,
    /// Names of the actuators, in the order of the loop.
    pub actuators: Vec<String>,
    /// Number of this part of the recording, from 1; 0 if unknown.
    pub part: u32,
}

impl Origin {
    /// Reads the header of a recording.
    pub fn of(recording: &Recording) -> Self {
        let about: &About = recording.about();
        let of_file = recording.path().file_name();
        Self {
            file: of_file.map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
            started: about.started(),
            plant: about.plant.clone(),
            software: about.software.clone(),
            git_hash: about.git_hash.clone(),
            config_sha256: about.config_sha256(),
            host: about.host.clone(),
            kernel: about.kernel.clone(),
            timer: about.timer.clone(),
            realtime: about.realtime.clone(),
            sensors: about.sensors.clone(),
            actuators: about.actuators.clone(),
            part: about.part,
        }
    }
}

/// How a file ends.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize)]
#[serde(tag = "kind", content = "words", rename_all = "snake_case")]
pub enum FileEnd {
    /// Ended by the recorder, with the reason.
    Finished(String),
    /// Incomplete, with the reason.
    Cut(String),
    /// Not ended: it was being written when it was read.
    BeingWritten(String),
    /// Unknown.
    #[default]
    Unknown,
}

impl FileEnd {
    /// The end of a recording after all its messages, or after the `cut` where
    /// reading stopped.
    pub fn of(recording: &Recording, cut: Option<&str>) -> Self {
        match (cut, recording.end()) {
            (Some(cut), _) if recording.is_being_written() => Self::BeingWritten(cut.to_owned()),
            (Some(cut), _) => Self::Cut(cut.to_owned()),
            (None, Some(end)) if recording.is_whole() => Self::Finished(end.ending.clone()),
            // The index that leads to the end is damaged, or other bytes follow it.
            (None, _) => Self::Unknown,
        }
    }
}
