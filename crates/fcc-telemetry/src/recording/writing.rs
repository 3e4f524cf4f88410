//! The recorder's thread: files begun, fed, committed each second, ended; and
//! begun again where the disk had failed.

use std::fmt::Write as _;
use std::io;
use std::mem;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use super::about::About;
use super::disk::Disk;
use super::file::RecordingFile;
use super::folder;
use super::lost::Lost;
use super::name::file_name;
use super::part::{Abandoned, Part};
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

/// Words that are kept for the next file while there is none.
const MAX_WORDS_KEPT: usize = 100;

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
    /// What is being written; none while the disk fails.
    part: Option<Part>,
    /// What is lost and not told in a file yet.
    lost: Lost,
    /// Why nothing was recorded, until a file has taken something again.
    trouble: Option<String>,
    /// Words for the next file.
    words: Vec<String>,
    /// When what had gathered was committed, or a file was to begin.
    acted: Instant,
    /// Whether the flight is over, and nothing is tried again.
    over: bool,
    /// Records and bytes in the parts before this one.
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
            part: None,
            lost: Lost::default(),
            trouble: None,
            words: Vec::new(),
            acted: Instant::now(),
            over: false,
            ticks_before: 0,
            bytes_before: 0,
        }
    }

    /// Writes until the flight ends, or whoever feeds is gone.
    pub(super) fn run(mut self, fed: &Receiver<Feed>) {
        self.begin();
        loop {
            let patience = self.pause().saturating_sub(self.acted.elapsed());
            match fed.recv_timeout(patience) {
                Ok(Feed::Message(message)) => self.take(&message),
                Ok(Feed::Remark(text)) => self.note(text),
                Ok(Feed::End(ending)) => return self.end(&ending),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.end("the recorder was dropped"),
            }
            let gathered = self.part.as_ref().map_or(0, Part::gathered_bytes);
            if self.acted.elapsed() < self.pause() && gathered < COMMIT_BYTES {
                continue;
            }
            if self.part.is_some() {
                self.commit();
            } else {
                self.begin();
            }
        }
    }

    /// Time between two commits, or between two attempts to begin.
    fn pause(&self) -> Duration {
        if self.part.is_some() {
            COMMIT_EVERY
        } else {
            self.settings.retry_every
        }
    }

    fn take(&mut self, message: &FlightMessage) {
        self.tell_gap(Some(message));
        if self.part.is_none() {
            return self.lose(message);
        }
        self.attempt(|part| part.take(message));
        if self.part.as_ref().is_some_and(|part| self.is_full(part)) {
            self.rotate();
        }
    }

    /// Tells of what is lost in the file, if there is one, before the message
    /// that ends the gap.
    fn tell_gap(&mut self, next: Option<&FlightMessage>) {
        if self.part.is_some() && !self.lost.is_none() {
            let gap = mem::take(&mut self.lost).event(next);
            self.attempt(|part| part.take(&gap));
        }
    }

    fn lose(&mut self, message: &FlightMessage) {
        if let Some(gap) = Lost::told_by(message) {
            self.lost.join(gap);
        } else {
            self.lost.widen(message);
            self.board.update(|status| status.not_recorded += 1);
        }
    }

    fn is_full(&self, part: &Part) -> bool {
        let too_large = |most| part.bytes() >= most;
        let too_old = |most: Duration| u128::from(part.span_ns()) >= most.as_nanos();
        self.settings.max_file_bytes.is_some_and(too_large)
            || self.settings.max_file_age.is_some_and(too_old)
    }

    /// Does something with the file, if there is one; deals with a disk that
    /// fails.
    fn attempt(&mut self, work: impl FnOnce(&mut Part) -> io::Result<()>) -> bool {
        let Some(part) = &mut self.part else {
            return false;
        };
        match work(part) {
            Ok(()) => true,
            Err(error) => {
                self.fail(&error);
                false
            }
        }
    }

    fn commit(&mut self) -> bool {
        let gaps = self.part.as_ref().map_or_else(Lost::default, Part::gaps);
        let committed = self.attempt(Part::commit);
        if committed {
            self.post();
            self.end_trouble(gaps);
            self.keep_below_total();
        }
        // From the end of it: on a slow disk the next must not follow at once.
        self.acted = Instant::now();
        committed
    }

    fn post(&mut self) {
        let part = self.part.as_ref();
        let (ticks, bytes) = part.map_or((0, 0), |part| (part.ticks(), part.bytes()));
        let (ticks, bytes) = (self.ticks_before + ticks, self.bytes_before + bytes);
        self.board.update(|status| {
            status.ticks = ticks;
            status.bytes = bytes;
        });
    }

    /// Says that the disk takes something again, if it had failed.
    fn end_trouble(&mut self, gaps: Lost) {
        if let (Some(part), Some(_)) = (&self.part, self.trouble.take()) {
            let mut lost = gaps;
            lost.join(self.lost);
            let path = part.path().display();
            let text = format!("recording goes on in {path}: {}", lost.words());
            self.tell(text, true);
            self.board.update(|status| status.stopped = None);
        }
    }

    fn end(mut self, ending: &str) {
        self.over = true;
        // A second time where a full disk got room, and another file, just now.
        for _ in 0..2 {
            self.tell_gap(None);
            if self.close(ending) || self.part.is_none() {
                break;
            }
        }
        if self.trouble.is_some() {
            self.post_trouble();
        }
    }

    fn rotate(&mut self) {
        if self.close("the recording goes on in its next file") {
            self.begin();
        }
    }

    /// Ends the present file as it should end; whether that worked.
    fn close(&mut self, ending: &str) -> bool {
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
        self.keep_below_total();
        self.about.part += 1;
        match self.begin_file() {
            Ok(file) => {
                let path = file.path().to_owned();
                if self.trouble.is_none() {
                    self.announce(format!("recording to {}", path.display()), false);
                }
                self.board.update(|status| {
                    status.file = Some(path.clone());
                    status.files.push(path);
                });
                self.part = Some(Part::new(file));
                for text in mem::take(&mut self.words) {
                    self.note(text);
                }
            }
            Err((path, error)) => {
                self.about.part -= 1;
                self.stop(format!(
                    "{}: cannot be written: {error}. Choose a folder that can, with --recordings \
                     or recording.folder",
                    path.display()
                ));
            }
        }
        self.acted = Instant::now();
    }

    /// Begins a file under a name that is free, where there is room or room
    /// may be made.
    fn begin_file(&mut self) -> Result<RecordingFile, (PathBuf, io::Error)> {
        for _ in 0..MAX_ATTEMPTS {
            let about = &self.about;
            let name = file_name(about.started_unix_ns, &about.aircraft, about.part);
            let path = self.settings.folder.join(name);
            let compression = self.settings.compression;
            match RecordingFile::begin(&mut *self.disk, &path, about, compression) {
                Ok(file) => return Ok(file),
                // Two flights in one millisecond: the second is a bit later.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    self.about.started_unix_ns += 1_000_000;
                }
                Err(error) if is_full(&error) && self.make_room() => {}
                Err(error) => return Err((path, error)),
            }
        }
        let path = self.settings.folder.clone();
        Err((path, io::ErrorKind::AlreadyExists.into()))
    }

    /// The disk failed: makes room if it may, or stops for now. The file stays
    /// as it was when last committed.
    fn fail(&mut self, error: &io::Error) {
        let Some(part) = self.part.take() else {
            return;
        };
        let Abandoned {
            path,
            kept,
            ticks,
            bytes,
            gaps,
            lost,
            remarks,
        } = part.abandon();
        self.ticks_before += ticks;
        self.bytes_before += bytes;
        self.lost.join(gaps);
        self.lost.join(lost);
        for text in remarks {
            self.note(text);
        }
        if !kept {
            self.about.part -= 1;
        }
        self.board.update(|status| {
            status.file = None;
            status.not_recorded += lost.count;
            status.files.retain(|file| kept || *file != path);
        });
        let what = format!("{}: {error}", path.display());
        if is_full(error) && self.make_room() {
            self.tell(format!("{what}; {}", self.lost.words()), true);
            self.begin();
        } else {
            self.stop(what);
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

    /// Nothing is recorded until the next attempt. Said once, however many
    /// attempts fail.
    fn stop(&mut self, why: String) {
        let is_new = self.trouble.replace(why).is_none();
        if is_new {
            let mut text = format!("recording stopped: {}", self.trouble_words());
            if !self.over {
                let every_s = self.settings.retry_every.as_secs_f64();
                let _ = write!(
                    text,
                    ". The flight goes on unrecorded; recording is tried again every {every_s} s"
                );
            }
            self.tell(text, true);
        }
        self.post_trouble();
        self.acted = Instant::now();
    }

    fn post_trouble(&self) {
        let words = self.trouble_words();
        self.board.update(|status| status.stopped = Some(words));
    }

    fn trouble_words(&self) -> String {
        let why = self.trouble.as_deref().unwrap_or_default();
        if self.lost.is_none() {
            why.to_owned()
        } else {
            format!("{why}; {}", self.lost.words())
        }
    }

    /// Says something, here and in the file.
    fn tell(&mut self, text: String, is_trouble: bool) {
        self.announce(text.clone(), is_trouble);
        self.note(text);
    }

    fn announce(&self, text: String, is_trouble: bool) {
        // Whoever flies may be gone already.
        let _ = self.news.send(News { text, is_trouble });
    }

    /// Puts words into the file, or into the next one.
    fn note(&mut self, text: String) {
        if self.part.is_some() {
            self.attempt(|part| part.remark(text));
        } else if self.words.len() < MAX_WORDS_KEPT {
            self.words.push(text);
        }
    }
}

/// Whether an error is of a kind that deleting files helps against.
fn is_full(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge
    )
}
