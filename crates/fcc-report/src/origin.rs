//! What a report says of where its flight comes from.

use serde::Serialize;

use fcc_record::{About, Recording};
use fcc_telemetry::Realtime;

/// Where a flight comes from: what its recording says of it beside the ticks.
/// A text that is empty is not known.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct Origin {
    /// The recording.
    pub file: String,
    /// When it began, in UTC.
    pub started: String,
    /// What flew.
    pub plant: String,
    /// Which program recorded.
    pub software: String,
    /// The commit it was built from.
    pub git_hash: String,
    /// SHA-256 of the configuration.
    pub config_sha256: String,
    /// The machine.
    pub host: String,
    /// Its kernel.
    pub kernel: String,
    /// Which timer woke the loop.
    pub timer: String,
    /// What the kernel granted the loop's thread.
    pub realtime: Realtime,
    /// Names of the sensors, by their place in the loop.
    pub sensors: Vec<String>,
    /// Names of the actuators, by their place in the loop.
    pub actuators: Vec<String>,
    /// Which part of the recording the file is, from 1; 0 if not known.
    pub part: u32,
}

impl Origin {
    /// What a recording says before its first message.
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
    /// As the recorder ended it, and why it did.
    Finished(String),
    /// It breaks off, and where.
    Cut(String),
    /// Nobody knows.
    #[default]
    Unknown,
}

impl FileEnd {
    /// The end of a recording whose messages were read until they were over,
    /// or until the `cut` that they tell of.
    pub fn of(recording: &Recording, cut: Option<&str>) -> Self {
        match (cut, recording.end()) {
            (Some(cut), _) => Self::Cut(cut.to_owned()),
            (None, Some(end)) if recording.is_whole() => Self::Finished(end.ending.clone()),
            // The index that leads there is damaged.
            (None, None) if recording.is_whole() => Self::Unknown,
            (None, _) => Self::Cut("its end is missing".to_owned()),
        }
    }
}
