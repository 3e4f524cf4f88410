//! Lists the recordings in a folder.

use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::Serialize;

use super::damage::Damage;
use super::reader::{OpenError, Recording, Verified};
use super::{folder, name};

/// Properties of one recording.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Entry {
    /// The file.
    #[serde(serialize_with = "name::serialize")]
    pub path: PathBuf,
    /// When the flight began, in UTC: `2026-11-20T04:21:33Z`, or `unknown`.
    pub started: String,
    /// The part number, from 1.
    pub part: u32,
    /// The plant.
    pub plant: String,
    /// From the first tick in the file to the last, s.
    pub duration_s: f64,
    /// Records in the file.
    pub ticks: u64,
    /// The greatest lateness of a wake-up, for a missed period too, µs.
    pub worst_lateness_us: f64,
    /// The loop's state at the last tick in the file.
    pub state: String,
    /// Why the flight, or the file, ended.
    pub ending: String,
    /// Records and events that reached the recorder and not the file.
    pub not_recorded: u64,
    /// Whether the file is finished and undamaged.
    pub file: Wholeness,
    /// The damage in it.
    pub damages: Vec<Damage>,
}

/// Whether a file is finished and undamaged.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wholeness {
    /// Finished and undamaged.
    Whole,
    /// Something in it is damaged: `fccd recover` saves the rest.
    Damaged,
    /// Unfinished, or copied without some ticks or events: `fccd recover` finishes it.
    Cut,
    /// It is being written.
    BeingWritten,
}

/// The recordings in a folder, oldest first.
///
/// # Errors
/// When the folder cannot be read.
pub fn files(of: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found: Vec<PathBuf> = fs::read_dir(of)?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|e| e == name::EXTENSION))
        .collect();
    folder::sort(of, &mut found);
    Ok(found)
}

/// Reads and verifies the whole file.
///
/// # Errors
/// When the file cannot be read or is not a recording.
pub fn entry(path: &Path) -> Result<Entry, OpenError> {
    let recording = Recording::open(path)?;
    let verified = recording.verify()?;
    Ok(describe(&recording, verified))
}

/// As [`entry`], but of a finished file only the beginning and the end are
/// read: damage between is not detected.
///
/// # Errors
/// When the file cannot be read or is not a recording.
pub fn glance(path: &Path) -> Result<Entry, OpenError> {
    let recording = Recording::open(path)?;
    match recording.end() {
        Some(end) => {
            let unverified = Verified {
                account: end.clone(),
                ..Verified::default()
            };
            Ok(describe(&recording, unverified))
        }
        None => entry(path),
    }
}

fn describe(recording: &Recording, verified: Verified) -> Entry {
    let about = recording.about();
    let path = recording.path();
    let file = if verified.cut.is_some() && recording.is_being_written() {
        Wholeness::BeingWritten
    } else if !verified.damages.is_empty() {
        Wholeness::Damaged
    } else if recording.is_whole() && verified.cut.is_none() {
        Wholeness::Whole
    } else {
        Wholeness::Cut
    };
    let account = verified.account;
    Entry {
        path: path.to_owned(),
        started: about.started(),
        part: about.part,
        plant: about.plant.clone(),
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
