//! The summaries of all recordings: each is read once, and what was found is kept beside.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fcc_record::Recording;
use serde_json::Value;
use tokio::sync::Mutex;

use super::scan::{self, Table};
use super::summary::{KEPT_POINTS, Summary, VERSION, stamp};
use crate::failure::Failure;
use crate::files;

/// What is kept of a recording, by the ends of its files' names.
const SUMMARY: &str = ".json";
const EVENTS: &str = ".events.json";
const TABLE: &str = ".curves.zst";
/// How long a list may take; what is not read by then is in the next one.
const LIST_WITHIN: Duration = Duration::from_millis(1_500);

/// The summaries of the recordings.
#[derive(Debug)]
pub(crate) struct Summaries {
    folder: PathBuf,
    /// Held while one is made for who opens a recording: one at a time.
    opening: Mutex<()>,
    /// Held by the list that makes some.
    listing: Mutex<()>,
}

impl Summaries {
    pub(crate) const fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            opening: Mutex::const_new(()),
            listing: Mutex::const_new(()),
        }
    }

    fn kept_file(&self, file: &str, end: &str) -> PathBuf {
        self.folder.join(format!("{file}{end}"))
    }

    pub(super) fn forget(&self, file: &str) {
        // One that stays is of a file that is not there.
        for end in [SUMMARY, EVENTS, TABLE] {
            let _ = fs::remove_file(self.kept_file(file, end));
        }
    }

    /// The summary that was kept, if it is of the file as it is.
    fn kept(&self, path: &Path) -> Option<Summary> {
        let (file, bytes, modified_ms) = stamp(path)?;
        let text = files::read_limited(&self.kept_file(&file, SUMMARY), 1 << 20).ok()?;
        let kept: Summary = serde_json::from_str(&text).ok()?;
        let is_of_it =
            (kept.version, kept.bytes, kept.modified_ms) == (VERSION, bytes, modified_ms);
        is_of_it.then_some(kept)
    }

    /// The summary of a recording that is opened. What a list reads does not hold it up.
    pub(super) fn summary(&self, path: &Path) -> Result<Summary, Failure> {
        let _turn = match self.kept(path) {
            Some(kept) => return Ok(kept),
            None => self.opening.blocking_lock(),
        };
        self.kept(path).map_or_else(|| self.read(path, || true), Ok)
    }

    /// Makes a summary, and keeps it if the recording is read to its end.
    fn read(&self, path: &Path, goes_on: impl Fn() -> bool) -> Result<Summary, Failure> {
        let (summary, events, table) = Summary::read(path, goes_on)?;
        if summary.is_complete() {
            // Without them it is read again.
            let _ = self.keep(&summary, &events, table.as_ref());
        }
        Ok(summary)
    }

    /// The summary last: with it the others are whole.
    fn keep(&self, summary: &Summary, events: &Value, table: Option<&Table>) -> io::Result<()> {
        fs::create_dir_all(&self.folder)?;
        let file = &summary.file;
        let parts = [
            (EVENTS, Some(events.to_string().into_bytes())),
            (TABLE, table.map(compressed).transpose()?),
            (SUMMARY, Some(serde_json::to_vec(summary)?)),
        ];
        for (end, content) in parts {
            if let Some(content) = content {
                files::replace(&self.kept_file(file, end), &content)?;
            }
        }
        Ok(())
    }

    /// A part that is kept of a recording, which is read for it if it was not yet.
    fn part(&self, path: &Path, end: &str) -> Option<Vec<u8>> {
        let summary = self.summary(path).ok()?;
        if summary.being_written {
            return None;
        }
        fs::read(self.kept_file(&summary.file, end)).ok()
    }

    /// Columns of a recording, thinned to so many rows.
    pub(super) fn table(
        &self,
        path: &Path,
        names: &[&str],
        points: usize,
    ) -> Result<Table, Failure> {
        let kept = if points <= KEPT_POINTS {
            self.part(path, TABLE)
                .and_then(|bytes| decompressed(&bytes))
        } else {
            None
        };
        let table = match kept {
            Some(kept) if kept.has(names) => kept.select(names)?,
            _ => scan::table(&Recording::open(path).map_err(Failure::bad)?, names)?,
        };
        Ok(table.thinned(points))
    }

    /// The events of a recording.
    pub(super) fn events(&self, path: &Path) -> Result<Value, Failure> {
        let kept = self.part(path, EVENTS);
        match kept.and_then(|bytes| serde_json::from_slice(&bytes).ok()) {
            Some(events) => Ok(events),
            None => Ok(Summary::read(path, || true)?.1),
        }
    }

    /// All recordings of a folder, the newest first.
    pub(super) fn list(&self, folder: &Path) -> Result<Value, Failure> {
        let mut files = match fcc_record::files(folder) {
            Ok(files) => files,
            Err(_) if !folder.exists() => Vec::new(),
            Err(error) => {
                return Err(Failure::internal(format!("{}: {error}", folder.display())));
            }
        };
        files.reverse();
        let begun = Instant::now();
        let turn = self.listing.try_lock();
        let may_read = || turn.is_ok() && self.opening.try_lock().is_ok();
        let listed = files
            .into_iter()
            .filter(|path| !path.is_symlink())
            .map(|path| {
                let known = self.kept(&path);
                if let Some(known) = known {
                    return known.listed();
                }
                let read = if begun.elapsed() > LIST_WITHIN || !may_read() {
                    Summary::begin(&path).map(|(summary, _)| summary)
                } else {
                    self.read(&path, may_read)
                };
                read.unwrap_or_else(|_| Summary::unread(&path)).listed()
            });
        Ok(listed.collect())
    }
}

fn compressed(table: &Table) -> io::Result<Vec<u8>> {
    zstd::encode_all(table.to_bytes().as_slice(), 1)
}

fn decompressed(bytes: &[u8]) -> Option<Table> {
    Table::of_bytes(&zstd::decode_all(bytes).ok()?)
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Message, State, Tick, Time};
    use fcc_record::{About, Recorder, RecorderSettings, RecordingPace};
    use fcc_telemetry::{FlightMessage, FlightRecord};

    use super::*;

    /// A folder with a recording of 100 ticks, and its summaries.
    fn recorded() -> (tempfile::TempDir, PathBuf, Summaries) {
        let folder = tempfile::tempdir().unwrap();
        let about = About {
            rate_hz: 40.0,
            ..About::default()
        };
        let settings = RecorderSettings {
            pace: RecordingPace::Lockstep,
            ..RecorderSettings::new(folder.path().join("recordings"))
        };
        let mut recorder = Recorder::start(about, settings).unwrap();
        for number in 0..100 {
            let woke = Time::from_nanos(i64::from(number) * 25_000_000);
            let tick = Tick {
                woke,
                ..Tick::default()
            };
            let record = FlightRecord::new(tick, State::Engaged);
            let message: FlightMessage = Message::Tick(record);
            recorder.take(&message);
        }
        let file = recorder.finish("stop requested").0.files[0].clone();
        let summaries = Summaries::new(folder.path().join("summaries"));
        (folder, file, summaries)
    }

    fn is_read(list: &Value) -> bool {
        list[0]["distance_m"].is_f64()
    }

    #[test]
    fn while_a_list_reads_a_recording_is_opened_at_once() {
        let (_folder, file, summaries) = recorded();
        let _list = summaries.listing.blocking_lock();
        assert!(summaries.summary(&file).unwrap().is_complete());
    }

    #[test]
    fn while_a_recording_is_opened_a_list_reads_none() {
        let (_folder, file, summaries) = recorded();
        let folder = file.parent().unwrap();
        let opening = summaries.opening.blocking_lock();
        let list = summaries.list(folder).unwrap();
        assert_eq!(list[0]["whole"], true);
        assert!(!is_read(&list) && summaries.kept(&file).is_none());
        drop(opening);
        assert!(is_read(&summaries.list(folder).unwrap()));
        // What is kept waits for no other one that is opened.
        let _opening = summaries.opening.blocking_lock();
        assert!(is_read(&summaries.list(folder).unwrap()));
        assert!(summaries.summary(&file).unwrap().is_complete());
    }

    #[test]
    fn a_list_stops_within_the_recording_that_it_reads() {
        let (_folder, file, summaries) = recorded();
        let asked = std::cell::Cell::new(0);
        let goes_on = || asked.replace(asked.get() + 1) < 10;
        assert!(!summaries.read(&file, goes_on).unwrap().is_complete());
        assert_eq!(asked.get(), 11);
        assert!(summaries.kept(&file).is_none());
    }
}
