//! The summaries of all recordings: each is read once, and what was found is kept beside.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use fcc_record::Recording;
use serde_json::Value;

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
    /// Held while one is made: one at a time.
    turn: Mutex<()>,
}

impl Summaries {
    pub(crate) const fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            turn: Mutex::new(()),
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

    /// The summary of a recording.
    pub(super) fn summary(&self, path: &Path) -> Result<Summary, Failure> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = self.kept(path) {
            return Ok(kept);
        }
        let (summary, events, table) = Summary::read(path)?;
        if !summary.being_written {
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
            None => Ok(Summary::read(path)?.1),
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
        let listed = files
            .into_iter()
            .filter(|path| !path.is_symlink())
            .map(|path| {
                let known = self.kept(&path);
                if let Some(known) = known {
                    return known.listed();
                }
                let read = if begun.elapsed() > LIST_WITHIN {
                    Summary::begin(&path).map(|(summary, _)| summary)
                } else {
                    self.summary(&path)
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
