//! The recorder's thread: files begun, fed, committed each second, ended.

use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use super::about::About;
use super::disk::Disk;
use super::file::RecordingFile;
use super::folder;
use super::name::file_name;
use super::recorder::Lost;
use super::settings::RecorderSettings;
use super::status::{Board, News};
use crate::FlightMessage;

/// How often what has gathered is written and synced. A loss of power costs
/// this much and the time that takes on a busy machine, and must cost less than
/// a second; more often is more work for the disk.
const COMMIT_EVERY: Duration = Duration::from_millis(700);

/// What has gathered is written before that if it is this much: a flight in
/// lockstep fills memory faster than any second passes.
const COMMIT_BYTES: u64 = 1 << 20;

/// Names tried, and recordings deleted, for one file to begin.
const MAX_ATTEMPTS: usize = 100;

/// What comes to the recorder's thread.
#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are messages, and a box for each would be work for nothing"
)]
pub(super) enum Feed {
    Message(FlightMessage),
    Remark(String),
    End(String),
}

/// The recorder's thread.
pub(super) struct Writing {
    disk: Box<dyn Disk>,
    about: About,
    settings: RecorderSettings,
    board: Board,
    news: Sender<News>,
    file: Option<RecordingFile>,
    /// What a failing disk would lose: given to the file, not yet committed.
    uncommitted: Lost,
    /// What was lost and is to be told in the next file.
    lost: Lost,
    committed: Instant,
    /// Records of the present file that are committed.
    committed_ticks: u64,
    /// Records and bytes in the files before this one.
    ticks_before: u64,
    bytes_before: u64,
}

impl Writing {
    pub(super) fn new(
        disk: Box<dyn Disk>,
        about: About,
        settings: RecorderSettings,
        board: Board,
        news: Sender<News>,
    ) -> Self {
        Self {
            disk,
            about: About { part: 0, ..about },
            settings,
            board,
            news,
            file: None,
            uncommitted: Lost::default(),
            lost: Lost::default(),
            committed: Instant::now(),
            committed_ticks: 0,
            ticks_before: 0,
            bytes_before: 0,
        }
    }

    /// Writes until the flight ends, or whoever feeds is gone.
    pub(super) fn run(mut self, fed: &Receiver<Feed>) {
        self.begin();
        loop {
            let patience = COMMIT_EVERY.saturating_sub(self.committed.elapsed());
            match fed.recv_timeout(patience) {
                Ok(Feed::Message(message)) => self.take(&message),
                Ok(Feed::Remark(text)) => {
                    self.attempt(|file| file.remark(text));
                }
                Ok(Feed::End(ending)) => return self.end(&ending),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.end("the recorder was dropped"),
            }
            let gathered = self.file.as_ref().map_or(0, RecordingFile::gathered_bytes);
            if self.committed.elapsed() >= COMMIT_EVERY || gathered >= COMMIT_BYTES {
                self.commit();
            }
        }
    }

    fn take(&mut self, message: &FlightMessage) {
        if self.file.is_none() {
            self.board.update(|status| status.not_recorded += 1);
            return;
        }
        if self.lost.count > 0 {
            let gap = std::mem::take(&mut self.lost);
            self.attempt(|file| file.take(&gap.event(Some(message))));
        }
        self.uncommitted.widen(message);
        self.attempt(|file| file.take(message));
        if self.file.as_ref().is_some_and(|file| self.is_full(file)) {
            self.rotate();
        }
    }

    fn is_full(&self, file: &RecordingFile) -> bool {
        let too_large = |most| file.bytes() >= most;
        let too_old = |most: Duration| u128::from(file.span_ns()) >= most.as_nanos();
        self.settings.max_file_bytes.is_some_and(too_large)
            || self.settings.max_file_age.is_some_and(too_old)
    }

    /// Does something with the file, if there is one; deals with a disk that
    /// fails.
    fn attempt(&mut self, work: impl FnOnce(&mut RecordingFile) -> io::Result<()>) -> bool {
        let Some(file) = &mut self.file else {
            return false;
        };
        match work(file) {
            Ok(()) => true,
            Err(error) => {
                self.fail(&error);
                false
            }
        }
    }

    fn commit(&mut self) {
        if self.attempt(RecordingFile::commit) {
            self.uncommitted = Lost::default();
            self.post();
            self.keep_below_total();
        }
        // From the end of it: on a slow disk the next must not follow at once.
        self.committed = Instant::now();
    }

    fn post(&mut self) {
        let (ticks, bytes) = self
            .file
            .as_ref()
            .map_or((0, 0), |file| (file.ticks(), file.bytes()));
        self.committed_ticks = ticks;
        let (ticks, bytes) = (self.ticks_before + ticks, self.bytes_before + bytes);
        self.board.update(|status| {
            status.ticks = ticks;
            status.bytes = bytes;
        });
    }

    fn end(mut self, ending: &str) {
        self.close(ending);
    }

    fn rotate(&mut self) {
        if self.close("the recording goes on in its next file") {
            self.begin();
        }
    }

    /// Ends the present file as it should end; whether that worked.
    fn close(&mut self, ending: &str) -> bool {
        if !self.attempt(RecordingFile::commit) {
            return false;
        }
        self.uncommitted = Lost::default();
        self.post();
        let Some(file) = self.file.take() else {
            return false;
        };
        self.ticks_before += file.ticks();
        self.bytes_before += file.bytes();
        let path = file.path().to_owned();
        let finished = file.finish(ending);
        self.board.update(|status| status.file = None);
        if let Err(error) = &finished {
            // All records are in it; what is missing is its index.
            self.stop(format!(
                "{}: not finished: {error}. Its records are safe: make room and run \
                 `fccd recover`",
                path.display()
            ));
        }
        finished.is_ok()
    }

    /// Begins the next file.
    fn begin(&mut self) {
        self.about.part += 1;
        self.keep_below_total();
        let mut begun = Err((PathBuf::new(), io::ErrorKind::AlreadyExists.into()));
        for _ in 0..MAX_ATTEMPTS {
            let name = file_name(
                self.about.started_unix_ns,
                &self.about.aircraft,
                self.about.part,
            );
            let path = self.settings.folder.join(name);
            let attempt = RecordingFile::begin(
                &mut *self.disk,
                &path,
                &self.about,
                self.settings.compression,
            );
            match attempt {
                // Two flights in one millisecond: the second is a bit later.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    self.about.started_unix_ns += 1_000_000;
                }
                Err(error) if is_full(&error) && self.make_room() => {}
                done => {
                    begun = done.map_err(|error| (path, error));
                    break;
                }
            }
        }
        match begun {
            Ok(file) => {
                let path = file.path().to_owned();
                self.tell(format!("recording to {}", path.display()), false);
                self.board.update(|status| {
                    status.file = Some(path.clone());
                    status.files.push(path);
                });
                self.file = Some(file);
                self.committed_ticks = 0;
            }
            Err((path, error)) => self.stop(format!(
                "{}: cannot be written: {error}. Choose a folder that can, with --recordings or \
                 recording.folder",
                path.display()
            )),
        }
        self.committed = Instant::now();
    }

    /// The disk failed: makes room if it may, or ends the recording. The file
    /// stays as it was when last committed.
    fn fail(&mut self, error: &io::Error) {
        let Some(file) = self.file.take() else {
            return;
        };
        let lost = std::mem::take(&mut self.uncommitted);
        self.ticks_before += self.committed_ticks;
        self.bytes_before += file.bytes();
        let path = file.path().to_owned();
        file.abandon();
        self.board.update(|status| {
            status.file = None;
            status.not_recorded += lost.count;
        });
        let gap = if lost.count == 0 {
            "nothing is lost".to_owned()
        } else {
            format!(
                "{} messages of ticks {} to {} are lost, all before is safe",
                lost.count, lost.first, lost.last
            )
        };
        let words = format!("{}: {error}; {gap}", path.display());
        if is_full(error) && self.make_room() {
            self.lost = lost;
            self.tell(words, true);
            self.begin();
        } else {
            self.stop(format!("{words}. The flight goes on unrecorded"));
        }
    }

    /// Deletes the oldest recording of another flight, if deleting is
    /// configured; whether it did.
    fn make_room(&mut self) -> bool {
        if self.settings.keep_total_bytes.is_none() {
            return false;
        }
        let own = self.board.read().files;
        let deleted = folder::delete_oldest(&self.settings.folder, &own);
        if let Some(path) = &deleted {
            self.tell(
                format!("{}: deleted, the disk is full", path.display()),
                false,
            );
        }
        deleted.is_some()
    }

    fn keep_below_total(&mut self) {
        let Some(most) = self.settings.keep_total_bytes else {
            return;
        };
        for path in folder::keep_below(&self.settings.folder, most) {
            let text = format!(
                "{}: deleted, to keep recordings below {} MB",
                path.display(),
                most / 1_000_000
            );
            self.tell(text, false);
        }
    }

    fn stop(&mut self, words: String) {
        self.tell(format!("recording stopped: {words}"), true);
        self.board.update(|status| {
            status.file = None;
            status.stopped = Some(words);
        });
    }

    fn tell(&self, text: String, is_trouble: bool) {
        // Whoever flies may be gone already.
        let _ = self.news.send(News { text, is_trouble });
    }
}

/// Whether an error is of a kind that deleting files helps against.
fn is_full(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge
    )
}
