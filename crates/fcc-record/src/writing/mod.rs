//! The recorder's thread: [files] begun, fed, committed each second, ended; and
//! begun again where the disk [had failed](trouble).

mod files;
mod trouble;

use std::io;
use std::mem;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use fcc_core::framework::MessageOf;

use super::about::About;
use super::disk::Disk;
use super::lost::Lost;
use super::part::Part;
use super::settings::RecorderSettings;
use super::status::{Board, News};
use crate::recorded::Recorded;

/// How often what has gathered is written and synced. A loss of power costs
/// this much and the time that takes on a busy machine, and must cost less than
/// a second; more often is more work for the disk.
const COMMIT_EVERY: Duration = Duration::from_millis(700);

/// What has gathered is written before that if it is this much: a flight in
/// lockstep fills memory faster than any second passes.
const COMMIT_BYTES: u64 = 1 << 20;

/// What comes to the recorder's thread.
#[derive(Debug)]
pub(super) enum Feed<M> {
    /// Boxed: the channel is allocated as a whole, and seldom holds many.
    Message(Box<M>),
    Remark(String),
    End(String),
}

/// The recorder's thread.
pub(super) struct Writing<C: Recorded> {
    disk: Box<dyn Disk>,
    about: About,
    settings: RecorderSettings,
    board: Board,
    news: Sender<News>,
    /// What is being written; none while the disk fails.
    part: Option<Part<C>>,
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

impl<C: Recorded> Writing<C> {
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
    pub(super) fn run(mut self, fed: &Receiver<Feed<MessageOf<C>>>) {
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

    /// Tells of what is lost in the file, if there is one, before the message
    /// that ends the gap.
    fn report_gap(&mut self, next: Option<&MessageOf<C>>) {
        if self.part.is_some() && !self.lost.is_none() {
            let gap = mem::take(&mut self.lost).event(next);
            self.attempt(|part| part.take(&gap));
        }
    }

    fn lose(&mut self, message: &MessageOf<C>) {
        if let Some(gap) = Lost::told_by(message) {
            self.lost.join(gap);
        } else {
            self.lost.widen(message);
            self.board.update(|status| status.not_recorded += 1);
        }
    }

    /// Does something with the file, if there is one; deals with a disk that
    /// fails.
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

    fn end(mut self, ending: &str) {
        self.over = true;
        // A second time where a full disk got room, and another file, just now.
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
