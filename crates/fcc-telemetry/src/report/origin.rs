//! What a report says of where its flight comes from.

use serde::Serialize;

use crate::Realtime;

/// Where a flight comes from: what its recording says of it beside the ticks.
/// A text that is empty is not known.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct Origin {
    /// The recording.
    pub file: String,
    /// When it began, in UTC.
    pub started: String,
    /// What flew.
    pub aircraft: String,
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

/// How the file ends.
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
