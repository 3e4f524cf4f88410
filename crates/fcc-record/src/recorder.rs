//! The recorder as who flies sees it: give it messages, never wait.

use std::io;
use std::panic::{self, AssertUnwindSafe};
use std::sync::mpsc::{self, Receiver, Sender, SyncSender, TrySendError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fcc_core::framework::MessageOf;

use super::about::About;
use super::disk::{Disk, FileSystem};
use super::lost::Lost;
use super::settings::{RecorderSettings, RecordingPace};
use super::status::{Board, News, RecorderStatus};
use super::writing::{Feed, Writing};
use crate::recorded::Recorded;

/// The name of a recorder's thread.
const THREAD_NAME: &str = "fcc-recorder";

/// How long the end of a flight waits for what is still on its way to the
/// disk: a disk that hangs must not keep a program from ending.
const PATIENCE: Duration = Duration::from_secs(10);
const POLL: Duration = Duration::from_millis(2);

/// Writes a flight's recording.
#[cfg(feature = "flight")]
pub type Recorder = RecorderOf<fcc_core::flight::Autopilot>;

/// Writes the recording of a loop in a thread of its own.
///
/// [`take`](Self::take) and [`remark`](Self::remark) never wait in real time:
/// what the disk is too slow for is dropped, and the gap is recorded. Whatever
/// goes wrong with the disk is [news](Self::news), and never an error of the
/// flight.
pub struct RecorderOf<C: Recorded> {
    feed: SyncSender<Feed<MessageOf<C>>>,
    pace: RecordingPace,
    lost: Lost,
    board: Board,
    news: Receiver<News>,
    thread: JoinHandle<()>,
}

impl<C: Recorded> RecorderOf<C> {
    /// Begins a recording in a folder of the file system.
    ///
    /// # Errors
    /// When there is no thread to be had. A folder that cannot be written to
    /// is no error: that is told as [news](Self::news).
    pub fn start(about: About, settings: RecorderSettings) -> io::Result<Self> {
        Self::start_on(Box::new(FileSystem), about, settings)
    }

    /// As [`start`](Self::start), on a disk of another kind.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn start_on(
        disk: Box<dyn Disk>,
        about: About,
        settings: RecorderSettings,
    ) -> io::Result<Self> {
        let (feed, fed) = mpsc::sync_channel(settings.capacity.max(1));
        let (tell, news) = mpsc::channel();
        let board = Board::default();
        let pace = settings.pace;
        let on_the_thread = board.clone();
        let write = move || {
            let (seen, say) = (on_the_thread.clone(), tell.clone());
            let writing = Writing::<C>::new(disk, about, settings, on_the_thread, tell);
            // The file stays as it was when last committed.
            if panic::catch_unwind(AssertUnwindSafe(|| writing.run(&fed))).is_err() {
                give_up(&seen, &say);
            }
        };
        let thread = thread::Builder::new()
            .name(THREAD_NAME.to_owned())
            .spawn(write)?;
        Ok(Self {
            feed,
            pace,
            lost: Lost::default(),
            board,
            news,
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

    /// Records words that are not an event of the loop.
    pub fn remark(&self, text: String) {
        // Words are no part of the flight: lost, they leave no gap.
        self.send(Feed::Remark(text));
    }

    /// What there is to say about the recording: where it goes, what was
    /// deleted for it, why it stopped. None if there is nothing new.
    pub fn news(&self) -> Option<News> {
        self.news.try_recv().ok()
    }

    /// How it does.
    pub fn status(&self) -> RecorderStatus {
        self.board.read()
    }

    /// Ends the recording; `ending` says in words why the flight ended. Waits
    /// for the disk, 10 s at most, and gives the last word on the recording and
    /// the news nobody asked for.
    pub fn finish(self, ending: &str) -> (RecorderStatus, Vec<News>) {
        let began = Instant::now();
        let last = (!self.lost.is_none()).then(|| Feed::Message(Box::new(self.lost.event(None))));
        for feed in last.into_iter().chain([Feed::End(ending.to_owned())]) {
            self.send_patiently(feed, began);
        }
        while !self.thread.is_finished() && began.elapsed() < PATIENCE {
            thread::sleep(POLL);
        }
        let trouble = (!self.thread.is_finished()).then(|| News {
            text: "the recording's end is not on the disk after 10 s: it does not answer"
                .to_owned(),
            is_trouble: true,
        });
        let news = self.news.try_iter().chain(trouble).collect();
        (self.board.read(), news)
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

    /// Tells of a gap before the message that ends it; whether there is none
    /// left to tell.
    fn report_gap(&mut self, next: &MessageOf<C>) -> bool {
        if self.lost.is_none() {
            return true;
        }
        let told = self.send(Feed::Message(Box::new(self.lost.event(Some(next)))));
        if told {
            self.lost = Lost::default();
        }
        told
    }

    fn lose(&mut self, message: &MessageOf<C>) {
        self.lost.widen(message);
        self.board.update(|status| status.not_recorded += 1);
    }
}

/// Says that the recorder itself is at fault, and that there is none any more.
fn give_up(board: &Board, say: &Sender<News>) {
    let words = "the recorder panicked; `fccd recover` saves what is there";
    board.update(|status| {
        status.file = None;
        status.stopped = Some(words.to_owned());
    });
    // Whoever flies may be gone already.
    let _ = say.send(News {
        text: format!("recording stopped: {words}"),
        is_trouble: true,
    });
}
