//! The recorder's thread: [files] are begun, written, committed and finished,
//! and begun again after the disk [failed](trouble).

mod files;
mod trouble;

use std::io;
use std::mem;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use fcc_core::framework::MessageOf;

use super::about::About;
use super::disk::Disk;
use super::document::Document;
use super::lost::Lost;
use super::part::Part;
use super::settings::RecorderSettings;
use super::status::{Board, Notice};
use crate::recorded::Recorded;

/// Interval between two commits. A loss of power costs this plus the time of a
/// commit on a busy machine, and must cost less than a second.
const COMMIT_EVERY: Duration = Duration::from_millis(700);

/// Commits earlier if this much is buffered: a flight in lockstep produces data
/// much faster than in real time.
const COMMIT_BYTES: u64 = 1 << 20;

/// Input of the recorder's thread.
#[derive(Debug)]
pub(super) enum Feed<M> {
    /// Boxed: the channel is allocated as a whole, and seldom holds many.
    Message(Box<M>),
    Remark(String),
    Document(Document),
    End(String),
}

/// The recorder's thread.
pub(super) struct Writing<C: Recorded> {
    disk: Box<dyn Disk>,
    about: About,
    settings: RecorderSettings,
    board: Board,
    notices: Sender<Notice>,
    /// The part being written; none while the disk fails.
    part: Option<Part<C>>,
    /// What is lost and not reported in a file yet.
    lost: Lost,
    /// Whether messages before those are lost, too.
    has_gaps: bool,
    /// Why nothing is recorded; none once a file has been committed again.
    trouble: Option<String>,
    /// Remarks for the next file.
    remarks: Vec<String>,
    /// Time of the last commit, or of the last attempt to begin a file.
    acted: Instant,
    /// Whether the flight has ended; then no attempt is repeated.
    ended: bool,
    /// Until when the folder is not looked through again.
    tidy_next: Instant,
    /// Whether it was reported that this recording alone is above the total.
    is_above_total: bool,
    /// Records and bytes in earlier parts.
    ticks_before: u64,
    bytes_before: u64,
}

impl<C: Recorded> Writing<C> {
    pub(super) fn new(
        disk: Box<dyn Disk>,
        about: About,
        settings: RecorderSettings,
        board: Board,
        notices: Sender<Notice>,
    ) -> Self {
        Self {
            disk,
            about: About { part: 0, ..about },
            settings,
            board,
            notices,
            part: None,
            lost: Lost::default(),
            has_gaps: false,
            trouble: None,
            remarks: Vec::new(),
            acted: Instant::now(),
            ended: false,
            tidy_next: Instant::now(),
            is_above_total: false,
            ticks_before: 0,
            bytes_before: 0,
        }
    }

    /// Writes until the flight ends or the recorder is dropped.
    pub(super) fn run(mut self, fed: &Receiver<Feed<MessageOf<C>>>) {
        self.begin();
        loop {
            let patience = self.pause().saturating_sub(self.acted.elapsed());
            match fed.recv_timeout(patience) {
                Ok(Feed::Message(message)) => self.take(&message),
                Ok(Feed::Remark(text)) => self.note(text),
                Ok(Feed::Document(document)) => self.keep(&document),
                Ok(Feed::End(ending)) => return self.end(&ending),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.end("the recorder was dropped"),
            }
            let gathered = self.part.as_ref().map_or(0, Part::<C>::gathered_bytes);
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

    fn take(&mut self, message: &MessageOf<C>) {
        self.report_gap(Some(message));
        if self.part.is_none() {
            return self.lose(message);
        }
        self.attempt(|part| part.take(message));
        if self.part.as_ref().is_some_and(|part| self.is_full(part)) {
            self.rotate();
        }
    }

    /// Writes a document, here and at the begin of each further file.
    fn keep(&mut self, document: &Document) {
        if self.about.documents.contains(document) {
            return;
        }
        // First, for the file that is begun if this one fails.
        self.about.documents.push(document.clone());
        self.attempt(|part| part.document(document));
    }

    /// Reports what is lost in the file, if there is one, before the message
    /// after the gap.
    fn report_gap(&mut self, next: Option<&MessageOf<C>>) {
        if self.part.is_some() && !self.lost.is_none() {
            let gap = mem::take(&mut self.lost).event(next);
            self.attempt(|part| part.take(&gap));
        }
    }

    fn lose(&mut self, message: &MessageOf<C>) {
        if let Some(gap) = Lost::reported_by(message) {
            self.lost.join(gap);
        } else {
            self.lost.widen(message);
            self.board.update(|status| status.not_recorded += 1);
        }
    }

    /// Writes to the file, if there is one; handles a failing disk.
    fn attempt(&mut self, work: impl FnOnce(&mut Part<C>) -> io::Result<()>) -> bool {
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
        if let (true, Some((what, lost))) = (committed, self.part.as_ref().and_then(Part::change)) {
            self.lose_file(&what, lost);
            return false;
        }
        if committed {
            self.post();
            self.end_trouble(gaps);
            self.has_gaps |= !gaps.is_none();
            self.keep_below_total();
        }
        // Counted from its end: on a slow disk the next must not follow at
        // once.
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

    fn end(mut self, ending: &str) {
        self.ended = true;
        // Twice: making room on a full disk begins another file.
        for _ in 0..2 {
            self.report_gap(None);
            if self.close(ending) || self.part.is_none() {
                break;
            }
        }
        if self.trouble.is_some() {
            self.post_trouble();
        }
    }
}
