//! Begins and finishes files, and deletes old ones to make room.

use std::io;
use std::mem;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::super::file::RecordingFile;
use super::super::folder;
use super::super::name::{MAX_NAMES, NAMES_APART_NS, file_name};
use super::super::opening::others_in;
use super::super::part::Part;
use super::Writing;
use crate::recorded::Recorded;

/// After looking through the folder it is not looked through for so many times
/// as long: others may have put any number of files there.
const TIDY_PAUSE: u32 = 20;

impl<C: Recorded> Writing<C> {
    pub(super) fn is_full(&self, part: &Part<C>) -> bool {
        let too_large = |most| part.bytes() >= most;
        let most_of_total = self.settings.keep_total_bytes.map(|total| total / 4);
        let too_old = |most: Duration| u128::from(part.span_ns()) >= most.as_nanos();
        self.settings.max_file_bytes.is_some_and(too_large)
            || most_of_total.is_some_and(too_large)
            || self.settings.max_file_age.is_some_and(too_old)
    }

    pub(super) fn rotate(&mut self) {
        if self.close("the recording continues in its next file") {
            self.begin();
        }
    }

    /// Finishes the present file; true if that succeeded.
    pub(super) fn close(&mut self, ending: &str) -> bool {
        if !self.commit() {
            return false;
        }
        let Some(part) = self.part.take() else {
            return false;
        };
        self.ticks_before += part.ticks();
        self.bytes_before += part.bytes();
        let path = part.path().to_owned();
        let finished = part.finish(ending);
        self.board.update(|status| status.file = None);
        if let Err(error) = &finished {
            // All records are in it; only its index is missing.
            self.stop(format!(
                "{}: not finished: {error}. Its records are complete: make room and run \
                 `fccd recover`",
                path.display()
            ));
        }
        finished.is_ok()
    }

    /// Begins the next file.
    pub(super) fn begin(&mut self) {
        self.about.part += 1;
        match self.begin_file() {
            Ok(file) => {
                let path = file.path().to_owned();
                if self.trouble.is_none() {
                    self.announce(format!("recording to {}", path.display()), false);
                }
                if self.about.part == 1
                    && let Some(others) = others_in(&self.settings.folder)
                {
                    let folder = self.settings.folder.display();
                    let text = format!(
                        "{folder} {others} can delete what is recorded there: choose a folder of \
                         your own, --recordings of fccd, or recording.folder"
                    );
                    self.announce(text, false);
                }
                self.board.update(|status| {
                    status.file = Some(path.clone());
                    status.files.push(path);
                });
                self.part = Some(Part::new(file));
                for text in mem::take(&mut self.remarks) {
                    self.note(text);
                }
                // First what is flown is recorded.
                self.keep_below_total();
            }
            Err((path, error)) => {
                self.about.part -= 1;
                let advice = if is_full(&error) {
                    "Make room on its disk"
                } else {
                    "Choose a writable folder: --recordings of fccd, or recording.folder"
                };
                let path = path.display();
                self.stop(format!("{path}: cannot be written: {error}. {advice}"));
            }
        }
        self.acted = Instant::now();
    }

    /// Begins a file under a free name; makes room if necessary and permitted.
    fn begin_file(&mut self) -> Result<RecordingFile<C>, (PathBuf, io::Error)> {
        // Names tried, and recordings deleted.
        for _ in 0..MAX_NAMES {
            let about = &self.about;
            let name = file_name(about.started_unix_ns, &about.plant, about.part);
            let path = self.settings.folder.join(name);
            let compression = self.settings.compression;
            match RecordingFile::begin(&mut *self.disk, &path, about, compression) {
                Ok(file) => {
                    if let Err(error) = folder::list_as_newest(&path) {
                        let folder = self.settings.folder.display();
                        self.remarks.push(format!(
                            "{folder}/.order: cannot be written: {error}: this recording counts as \
                             old when room is made: remove it, as the user of fccd"
                        ));
                    }
                    return Ok(file);
                }
                // Two flights in one millisecond: the second is given a later
                // one.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    self.about.started_unix_ns += NAMES_APART_NS;
                }
                Err(error) if is_full(&error) && self.make_room() => {}
                Err(error) => return Err((path, error)),
            }
        }
        let path = self.settings.folder.clone();
        Err((path, io::ErrorKind::AlreadyExists.into()))
    }

    /// Deletes the oldest recording of another flight, if deleting is
    /// configured; true if it deleted one.
    pub(super) fn make_room(&mut self) -> bool {
        if self.settings.keep_total_bytes.is_none() {
            return false;
        }
        let own = self.board.read().files;
        let deleted = folder::delete_oldest(&self.settings.folder, &own);
        if let Some(path) = &deleted {
            self.report(
                format!("{}: deleted, the disk is full", path.display()),
                false,
            );
        }
        deleted.is_some()
    }

    pub(super) fn keep_below_total(&mut self) {
        let Some(most) = self.settings.keep_total_bytes else {
            return;
        };
        let began = Instant::now();
        if began < self.tidy_next {
            return;
        }
        let own = self.board.read().files;
        let bytes = self.bytes_before + self.part.as_ref().map_or(0, Part::bytes);
        if bytes > most && !self.is_above_total {
            self.is_above_total = true;
            let text = format!(
                "this recording alone has more than keep_total_mb, {} MB: it goes on, and none of \
                 its files is deleted before it ends",
                most / 1_000_000
            );
            self.report(text, false);
        }
        for path in folder::keep_below(&self.settings.folder, most, &own) {
            let text = format!(
                "{}: deleted, to keep recordings below {} MB",
                path.display(),
                most / 1_000_000
            );
            self.report(text, false);
        }
        self.tidy_next = Instant::now() + began.elapsed() * TIDY_PAUSE;
    }
}

/// Whether deleting files can help against an error.
pub(super) fn is_full(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge
    )
}
