//! The recordings in a folder, at a glance.

use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::Serialize;

use super::reader::{OpenError, Recording};
use super::{disk, name, utc};

/// One recording at a glance.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Entry {
    /// The file.
    pub path: PathBuf,
    /// When the flight began, in UTC: `2026-11-20T04:21:33Z`.
    pub started: String,
    /// Which part of the flight's recording this is, from 1.
    pub part: u32,
    /// What flew.
    pub aircraft: String,
    /// From the first tick in the file to the last.
    pub duration_s: f64,
    /// Records in the file.
    pub ticks: u64,
    /// How late the loop woke at worst.
    pub worst_lateness_us: f64,
    /// The loop's state at the last tick in the file.
    pub state: String,
    /// Why the flight, or the file, ended.
    pub ending: String,
    /// Records and events that came to the recorder and not into the file.
    pub not_recorded: u64,
    /// How the file ends.
    pub file: Wholeness,
}

/// How a file ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wholeness {
    /// As it should.
    Whole,
    /// It was cut off: `fccd recover` makes it whole.
    Cut,
    /// Not yet: it is being written.
    BeingWritten,
}

/// The files in a folder that end like recordings, the oldest first.
///
/// # Errors
/// When the folder cannot be read.
pub fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found: Vec<PathBuf> = fs::read_dir(folder)?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|e| e == name::EXTENSION))
        .collect();
    found.sort();
    Ok(found)
}

/// One recording at a glance. A whole one is read at its two ends only, a cut
/// one from the first message to the last.
///
/// # Errors
/// When the file cannot be read or is something else.
pub fn entry(path: &Path) -> Result<Entry, OpenError> {
    let recording = Recording::open(path)?;
    let end = recording.account()?;
    let about = recording.about();
    let file = if recording.is_whole() {
        Wholeness::Whole
    } else if disk::is_being_written(path) {
        Wholeness::BeingWritten
    } else {
        Wholeness::Cut
    };
    Ok(Entry {
        path: path.to_owned(),
        started: utc::timestamp(about.started_unix_ns),
        part: about.part,
        aircraft: about.aircraft.clone(),
        duration_s: end.duration_ns as f64 * 1e-9,
        ticks: end.ticks,
        worst_lateness_us: end.worst_lateness_ns as f64 * 1e-3,
        state: end.state,
        ending: end.ending,
        not_recorded: end.not_recorded,
        file,
    })
}
