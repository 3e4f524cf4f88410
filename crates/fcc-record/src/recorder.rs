//! The recorder: takes messages without waiting.

use std::io;
use std::panic::{self, AssertUnwindSafe};
use std::sync::mpsc::{self, Receiver, Sender, SyncSender, TrySendError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fcc_core::framework::MessageOf;
use fcc_telemetry::not_started;

use super::about::About;
use super::disk::{Disk, FileSystem};
use super::document::Document;
use super::lost::Lost;
use super::settings::{RecorderSettings, RecordingPace};
use super::status::{Board, Notice, RecorderStatus};
use super::writing::{Feed, Writing};
use crate::recorded::Recorded;

/// The name of a recorder's thread.
const THREAD_NAME: &str = "fcc-recorder";
/// Given explicitly, so that `RUST_MIN_STACK` does not change it.
const STACK_BYTES: usize = 2 << 20;

/// How long the end of a flight waits for the disk: a disk that hangs must not
/// keep the program from ending.
const PATIENCE: Duration = Duration::from_secs(10);
const POLL: Duration = Duration::from_millis(2);

/// Writes a flight's recording.
#[cfg(feature = "flight")]
pub type Recorder = RecorderOf<fcc_fixed_wing::Autopilot>;

/// Writes the recording of a loop in its own thread.
///
/// [`take`](Self::take) and [`remark`](Self::remark) never wait in real time:
/// messages for which the disk is too slow are dropped, and the gap is
/// recorded. Disk failures are [notices](Self::notice), and never an error of
/// the flight.
pub struct RecorderOf<C: Recorded> {
    feed: SyncSender<Feed<MessageOf<C>>>,
    pace: RecordingPace,
    lost: Lost,
    board: Board,
    notices: Receiver<Notice>,
    thread: JoinHandle<()>,
}

impl<C: Recorded> RecorderOf<C> {
    /// Begins a recording in a folder of the file system.
    ///
    /// # Errors
    /// When no thread can be started. A folder that cannot be written to is a
    /// [notice](Self::notice) and not an error.
    pub fn start(about: About, settings: RecorderSettings) -> io::Result<Self> {
        Self::start_on(Box::new(FileSystem), about, settings)
    }

    /// As [`start`](Self::start), on another kind of disk.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn start_on(
        disk: Box<dyn Disk>,
        about: About,
        settings: RecorderSettings,
    ) -> io::Result<Self> {
        let (feed, fed) = mpsc::sync_channel(settings.capacity.max(1));
        let (sender, notices) = mpsc::channel();
        let board = Board::default();
        let pace = settings.pace;
        let on_the_thread = board.clone();
        let write = move || {
            let (seen, report) = (on_the_thread.clone(), sender.clone());
            let writing = Writing::<C>::new(disk, about, settings, on_the_thread, sender);
            // The file stays as it was when last committed.
            if panic::catch_unwind(AssertUnwindSafe(|| writing.run(&fed))).is_err() {
                give_up(&seen, &report);
            }
        };
        let thread = thread::Builder::new()
            .name(THREAD_NAME.to_owned())
            .stack_size(STACK_BYTES)
            .spawn(write)
            .map_err(not_started)?;
        Ok(Self {
            feed,
            pace,
            lost: Lost::default(),
            board,
            notices,
            thread,
        })
    }

    /// Records a message. In real time it never waits; in lockstep it waits for
    /// the disk.
    pub fn take(&mut self, message: &MessageOf<C>) {
        if !self.report_gap(message) || !self.send(Feed::Message(Box::new(*message))) {
            self.lose(message);
        }
    }

    /// Records text that is not an event of the loop.
    pub fn remark(&self, text: String) {
        // Remarks are not part of the flight: if lost, they leave no gap.
        self.send(Feed::Remark(text));
    }

    /// Records a document, before the messages that are given later.
    pub fn document(&self, document: Document) {
        // If there is no room, there is none for those messages either.
        self.send(Feed::Document(document));
    }

    /// The next notice about the recording: its file, what was deleted for it,
    /// why it stopped. None if there is none.
    pub fn notice(&self) -> Option<Notice> {
        self.notices.try_recv().ok()
    }

    /// The status.
    pub fn status(&self) -> RecorderStatus {
        self.board.read()
    }

    /// Ends the recording; `ending` is the reason, as text. Waits for the disk,
    /// at most 10 s, and returns the final status and the notices not taken
    /// yet.
    pub fn finish(self, ending: &str) -> (RecorderStatus, Vec<Notice>) {
        let began = Instant::now();
        let last = (!self.lost.is_none()).then(|| Feed::Message(Box::new(self.lost.event(None))));
        for feed in last.into_iter().chain([Feed::End(ending.to_owned())]) {
            self.send_patiently(feed, began);
        }
        while !self.thread.is_finished() && began.elapsed() < PATIENCE {
            thread::sleep(POLL);
        }
        let mut status = self.board.read();
        let trouble = (!self.thread.is_finished()).then(|| {
            let text = "the recording is not finished after 10 s: the disk does not respond";
            status.stopped.get_or_insert_with(|| text.to_owned());
            Notice {
                text: text.to_owned(),
                is_trouble: true,
            }
        });
        let notices = self.notices.try_iter().chain(trouble).collect();
        (status, notices)
    }

    fn send(&self, feed: Feed<MessageOf<C>>) -> bool {
        match self.pace {
            RecordingPace::RealTime => self.feed.try_send(feed).is_ok(),
            RecordingPace::Lockstep => self.feed.send(feed).is_ok(),
        }
    }

    fn send_patiently(&self, mut feed: Feed<MessageOf<C>>, began: Instant) {
        while began.elapsed() < PATIENCE {
            match self.feed.try_send(feed) {
                Ok(()) | Err(TrySendError::Disconnected(_)) => return,
                Err(TrySendError::Full(back)) => feed = back,
            }
            thread::sleep(POLL);
        }
    }

    /// Reports a gap before the message after it; true if no gap is left to
    /// report.
    fn report_gap(&mut self, next: &MessageOf<C>) -> bool {
        if self.lost.is_none() {
            return true;
        }
        let reported = self.send(Feed::Message(Box::new(self.lost.event(Some(next)))));
        if reported {
            self.lost = Lost::default();
        }
        reported
    }

    fn lose(&mut self, message: &MessageOf<C>) {
        self.lost.widen(message);
        self.board.update(|status| status.not_recorded += 1);
    }
}

/// Reports that the recorder itself failed and has ended.
fn give_up(board: &Board, report: &Sender<Notice>) {
    let text = "the recorder panicked; `fccd recover` saves what is there";
    board.update(|status| {
        status.file = None;
        status.stopped = Some(text.to_owned());
    });
    // The flight may have ended already.
    let _ = report.send(Notice {
        text: format!("recording stopped: {text}"),
        is_trouble: true,
    });
}
