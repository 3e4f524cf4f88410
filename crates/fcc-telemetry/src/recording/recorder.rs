//! The recorder as who flies sees it: give it messages, never wait.

use std::io;
use std::sync::mpsc::{self, Receiver, SyncSender, TrySendError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fcc_core::framework::{Event, EventKind, Time};

use super::about::About;
use super::disk::{Disk, FileSystem};
use super::settings::{RecorderSettings, RecordingPace};
use super::status::{Board, News, RecorderStatus};
use super::writing::{Feed, Writing};
use crate::FlightMessage;

/// The name of a recorder's thread.
const THREAD_NAME: &str = "fcc-recorder";

/// How long the end of a flight waits for what is still on its way to the
/// disk: a disk that hangs must not keep a program from ending.
const PATIENCE: Duration = Duration::from_secs(10);
const POLL: Duration = Duration::from_millis(2);

/// Writes a flight's recording in a thread of its own.
///
/// [`take`](Self::take) and [`remark`](Self::remark) never wait in real time:
/// what the disk is too slow for is dropped, and the gap is recorded. Whatever
/// goes wrong with the disk is [news](Self::news), and never an error of the
/// flight.
#[derive(Debug)]
pub struct Recorder {
    feed: SyncSender<Feed>,
    pace: RecordingPace,
    lost: Lost,
    board: Board,
    news: Receiver<News>,
    thread: JoinHandle<()>,
}

impl Recorder {
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
        let thread = thread::Builder::new()
            .name(THREAD_NAME.to_owned())
            .spawn(move || Writing::new(disk, about, settings, on_the_thread, tell).run(&fed))?;
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
    pub fn take(&mut self, message: &FlightMessage) {
        if !self.tell_gap(message) || !self.send(Feed::Message(*message)) {
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
        let last = (self.lost.count > 0).then(|| Feed::Message(self.lost.event(None)));
        for feed in last.into_iter().chain([Feed::End(ending.to_owned())]) {
            self.send_patiently(feed, began);
        }
        while !self.thread.is_finished() && began.elapsed() < PATIENCE {
            thread::sleep(POLL);
        }
        let trouble = if !self.thread.is_finished() {
            Some("the recording's end is not on the disk after 10 s: it does not answer")
        } else if self.thread.join().is_err() {
            Some("recording stopped: the recorder panicked; `fccd recover` saves what is there")
        } else {
            None
        };
        let trouble = trouble.map(|text| News {
            text: text.to_owned(),
            is_trouble: true,
        });
        let news = self.news.try_iter().chain(trouble).collect();
        (self.board.read(), news)
    }

    fn send(&self, feed: Feed) -> bool {
        match self.pace {
            RecordingPace::RealTime => self.feed.try_send(feed).is_ok(),
            RecordingPace::Lockstep => self.feed.send(feed).is_ok(),
        }
    }

    fn send_patiently(&self, mut feed: Feed, began: Instant) {
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
    fn tell_gap(&mut self, next: &FlightMessage) -> bool {
        if self.lost.count == 0 {
            return true;
        }
        let told = self.send(Feed::Message(self.lost.event(Some(next))));
        if told {
            self.lost = Lost::default();
        }
        told
    }

    fn lose(&mut self, message: &FlightMessage) {
        self.lost.widen(message);
        self.board.update(|status| status.not_recorded += 1);
    }
}

/// Messages that are missing between two that are not.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lost {
    pub(super) count: u64,
    pub(super) first: u64,
    pub(super) last: u64,
}

impl Lost {
    pub(super) fn widen(&mut self, message: &FlightMessage) {
        let (tick, _) = place(message);
        if self.count == 0 {
            self.first = tick;
        }
        self.count += 1;
        self.last = tick;
    }

    /// The gap as an event, at the message that ends it.
    pub(super) fn event(&self, next: Option<&FlightMessage>) -> FlightMessage {
        let (tick, time) = next.map_or((self.last, Time::NEVER), place);
        FlightMessage::Event(Event {
            tick,
            time,
            kind: EventKind::NotRecorded {
                count: self.count,
                first: self.first,
                last: self.last,
            },
        })
    }
}

fn place(message: &FlightMessage) -> (u64, Time) {
    match message {
        FlightMessage::Tick(record) => (record.tick.number, record.tick.woke),
        FlightMessage::Event(event) => (event.tick, event.time),
    }
}
