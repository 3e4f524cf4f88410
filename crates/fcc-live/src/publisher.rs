//! The daemon's end: takes what is to be published, and never waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread::JoinHandle;
use std::time::Duration;

use fcc_core::framework::RecordOf;
use rtrb::{Producer, RingBuffer};

use super::command::{Asked, CommandServer, Ends, Verdict};
use super::thread::{self, Started};
use super::{Event, Info, PublishError, RecorderStatus};
use fcc_telemetry::{Instance, Telemetry};

/// How long publishing may take to start, and to end. Neither a flight nor its
/// end waits longer.
const PATIENCE: Duration = Duration::from_secs(2);

/// What goes to the publishing thread: plain data of a fixed size, which could
/// as well go to another process.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are records, and the ring's slots have their size"
)]
pub(super) enum Item<C: Telemetry> {
    /// Each tick.
    Record(RecordOf<C>),
    /// What happened once.
    Event(Event),
    /// Who publishes; once, and again if it changes.
    Info(Info),
    /// How recording goes.
    Recorder(RecorderStatus),
}

/// Publishes a flight to whoever watches.
#[cfg(feature = "flight")]
pub type Publisher = PublisherOf<fcc_core::flight::Autopilot>;

/// Publishes what happens to whoever watches.
///
/// Everything handed over goes to a thread of its own by a ring; where that is
/// full, it is left out and counted. Dropping a publisher ends the services.
#[derive(Debug)]
pub struct PublisherOf<C: Telemetry> {
    ring: Producer<Item<C>>,
    /// Records for which there was no room, for the next status.
    left_out: Arc<AtomicU64>,
    thread: JoinHandle<()>,
    words: Receiver<String>,
    commands: Option<Ends>,
    over: bool,
}

impl<C: Telemetry> PublisherOf<C> {
    /// Starts to publish as `instance`, and takes no commands. Up to `waiting`
    /// records wait to be published: two seconds of them are enough, as the
    /// publishing thread may be held up for one when a watcher joins or leaves.
    ///
    /// # Errors
    /// When there is no shared memory to be had, or the name is taken. Whoever
    /// flies goes on without.
    pub fn start(instance: &Instance, waiting: usize) -> Result<Self, PublishError> {
        Self::start_thread(instance, waiting, false)
    }

    /// Starts to publish as `instance`, and to take commands: who flies looks
    /// for them by [`next_command`](Self::next_command) and answers each.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn start_with_commands(instance: &Instance, waiting: usize) -> Result<Self, PublishError> {
        Self::start_thread(instance, waiting, true)
    }

    fn start_thread(
        instance: &Instance,
        waiting: usize,
        takes_orders: bool,
    ) -> Result<Self, PublishError> {
        let (ring, items) = RingBuffer::new(waiting.max(1));
        let (started, start) = mpsc::sync_channel::<Started>(1);
        // More than the thread will ever have to say unheard.
        let (say, words) = mpsc::sync_channel(16);
        let (commands, rings) = takes_orders.then(CommandServer::rings).unzip();
        let owned = instance.clone();
        let left_out = Arc::new(AtomicU64::new(0));
        let seen = Arc::clone(&left_out);
        let thread = std::thread::Builder::new()
            .name(thread::NAME.to_owned())
            .stack_size(thread::STACK_BYTES)
            .spawn(move || thread::publish(&owned, rings, items, &seen, &started, &say))
            .map_err(|error| PublishError::NoSharedMemory(error.to_string()))?;
        match start.recv_timeout(PATIENCE) {
            Ok(Ok(())) => Ok(Self {
                ring,
                left_out,
                thread,
                words,
                commands,
                over: false,
            }),
            Ok(Err(error)) => Err(error),
            Err(RecvTimeoutError::Timeout) => Err(PublishError::NoSharedMemory(
                "it does not answer: end all programs of this user that fly or watch, then remove \
                 what they left, /dev/shm/fccd-*"
                    .to_owned(),
            )),
            Err(RecvTimeoutError::Disconnected) => Err(PublishError::NoSharedMemory(
                "iceoryx2 failed: its words are above".to_owned(),
            )),
        }
    }

    /// Publishes a tick.
    pub fn record(&mut self, record: &RecordOf<C>) {
        self.put(Item::Record(*record));
    }

    /// Publishes what happened once.
    pub fn event(&mut self, event: Event) {
        self.put(Item::Event(event));
    }

    /// Publishes who publishes; before this nobody can watch.
    pub fn describe(&mut self, info: Info) {
        let record_bytes = size_of::<C::Words>() as u32;
        self.put(Item::Info(Info {
            record_bytes,
            ..info
        }));
    }

    /// Tells how recording goes: it is in the next status.
    pub fn recorder(&mut self, status: RecorderStatus) {
        self.put(Item::Recorder(status));
    }

    /// The next command from another program, if there is one. Each wants its
    /// [`answer`](Self::answer).
    pub fn next_command(&mut self) -> Option<Asked> {
        self.commands.as_ref()?.commands.try_recv().ok()
    }

    /// Says what became of a command.
    pub fn answer(&mut self, id: u64, verdict: Verdict) {
        if let Some(ends) = &self.commands {
            // As many answers as commands have room; a thread that is gone has
            // nobody to tell.
            let _ = ends.verdicts.try_send((id, verdict));
        }
    }

    /// Wakes the publishing thread: what was handed over is published now and
    /// not within the next 20 ms.
    pub fn flush(&self) {
        self.thread.thread().unpark();
    }

    /// Trouble, or the end of it, in words; none if there is nothing new.
    pub fn poll(&mut self) -> Option<String> {
        if let Ok(words) = self.words.try_recv() {
            return Some(words);
        }
        if self.ring.is_abandoned() && !self.over {
            self.over = true;
            return Some("live telemetry has failed: nobody can watch from here on".to_owned());
        }
        None
    }

    fn put(&mut self, item: Item<C>) {
        let is_record = matches!(item, Item::Record(_));
        if self.ring.push(item).is_err() && is_record {
            self.left_out.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl<C: Telemetry> Drop for PublisherOf<C> {
    fn drop(&mut self) {
        // The thread sees the ring abandoned; what is in it is still published.
        let (ring, _) = RingBuffer::new(1);
        drop(std::mem::replace(&mut self.ring, ring));
        self.flush();
        thread::wait(&self.thread, PATIENCE);
    }
}
