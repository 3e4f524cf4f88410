//! The recordings in a folder, at a glance.

use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::Serialize;

use super::damage::Damage;
use super::reader::{OpenError, Recording, Verified};
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
    /// Whether the file is whole.
    pub file: Wholeness,
    /// What is damaged in it.
    pub damages: Vec<Damage>,
}

/// Whether a file is whole.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wholeness {
    /// It ends as it should.
    Whole,
    /// Something in it is damaged: `fccd recover` makes the rest whole.
    Damaged,
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

/// One recording at a glance, read through and verified.
///
/// # Errors
/// When the file cannot be read or is something else.
pub fn entry(path: &Path) -> Result<Entry, OpenError> {
    let recording = Recording::open(path)?;
    let verified = recording.verify()?;
    Ok(describe(&recording, verified))
}

/// As [`entry`], but a file that ends as it should is read at its two ends
/// only: damage before its end is not seen.
///
/// # Errors
/// When the file cannot be read or is something else.
pub fn glance(path: &Path) -> Result<Entry, OpenError> {
    let recording = Recording::open(path)?;
    match recording.end() {
        Some(end) => {
            let believed = Verified {
                account: end.clone(),
                ..Verified::default()
            };
            Ok(describe(&recording, believed))
        }
        None => entry(path),
    }
}

fn describe(recording: &Recording, verified: Verified) -> Entry {
    let about = recording.about();
    let path = recording.path();
    let file = if verified.cut.is_some() && disk::is_being_written(path) {
        Wholeness::BeingWritten
    } else if !verified.damages.is_empty() {
        Wholeness::Damaged
    } else if recording.is_whole() {
        Wholeness::Whole
    } else {
        Wholeness::Cut
    };
    let account = verified.account;
    Entry {
        path: path.to_owned(),
        started: utc::timestamp(about.started_unix_ns),
        part: about.part,
        aircraft: about.aircraft.clone(),
        duration_s: account.duration_ns as f64 * 1e-9,
        ticks: account.ticks,
        worst_lateness_us: account.worst_lateness_ns as f64 * 1e-3,
        state: account.state,
        ending: account.ending,
        not_recorded: account.not_recorded,
        file,
        damages: verified.damages,
    }
}
