//! The daemon's side: takes messages to publish, without waiting.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread::JoinHandle;
use std::time::Duration;

use fcc_core::framework::RecordOf;
use rtrb::{Producer, RingBuffer};

use super::command::{CommandServer, Ends, PendingCommand, Verdict};
use super::item::Item;
use super::thread::{self, Started};
use super::{Event, Info, PublishError, RecorderStatus};
use fcc_telemetry::schema::words;
use fcc_telemetry::{Instance, Telemetry};

/// How long the start and the end of publishing may take. A flight waits no
/// longer.
const PATIENCE: Duration = Duration::from_secs(2);

/// Publishes a flight.
#[cfg(feature = "flight")]
pub type Publisher = PublisherOf<fcc_core::flight::Autopilot>;

/// Publishes the messages of a loop.
///
/// Messages go through a ring to a separate thread. If the ring is full, they
/// are dropped and counted. Dropping a publisher ends the services.
#[derive(Debug)]
pub struct PublisherOf<C: Telemetry> {
    ring: Producer<Item<C>>,
    /// Dropped records, for the next status.
    left_out: Arc<AtomicU64>,
    thread: JoinHandle<()>,
    texts: Receiver<String>,
    commands: Option<Ends>,
    over: bool,
}

impl<C: Telemetry> PublisherOf<C> {
    /// Starts to publish as `instance`, without commands. Up to `waiting` records
    /// wait to be published: two seconds of them are enough, because a watcher
    /// that joins or leaves may delay the publishing thread by one.
    ///
    /// # Errors
    /// When no shared memory is available, or the name is taken. The flight
    /// continues without.
    pub fn start(instance: &Instance, waiting: usize) -> Result<Self, PublishError> {
        Self::start_thread(instance, waiting, false)
    }

    /// Starts to publish as `instance`, and to receive commands: poll
    /// [`next_command`](Self::next_command) and answer each.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn start_with_commands(instance: &Instance, waiting: usize) -> Result<Self, PublishError> {
        Self::start_thread(instance, waiting, true)
    }

    fn start_thread(
        instance: &Instance,
        waiting: usize,
        takes_commands: bool,
    ) -> Result<Self, PublishError> {
        let (ring, items) = RingBuffer::new(waiting.max(1));
        let (started, start) = mpsc::sync_channel::<Started>(1);
        // More than the thread ever reports between two polls.
        let (reports, texts) = mpsc::sync_channel(16);
        let (commands, rings) = takes_commands.then(CommandServer::rings).unzip();
        let owned = instance.clone();
        let left_out = Arc::new(AtomicU64::new(0));
        let seen = Arc::clone(&left_out);
        let thread = std::thread::Builder::new()
            .name(thread::NAME.to_owned())
            .stack_size(thread::STACK_BYTES)
            .spawn(move || thread::publish(&owned, rings, items, &seen, &started, &reports))
            .map_err(|error| PublishError::NoSharedMemory(error.to_string()))?;
        match start.recv_timeout(PATIENCE) {
            Ok(Ok(())) => Ok(Self {
                ring,
                left_out,
                thread,
                texts,
                commands,
                over: false,
            }),
            Ok(Err(error)) => Err(error),
            Err(RecvTimeoutError::Timeout) => Err(PublishError::NoSharedMemory(
                "it does not respond: end all programs of this user that fly or watch, then remove \
                 their files, /dev/shm/fccd-*"
                    .to_owned(),
            )),
            Err(RecvTimeoutError::Disconnected) => Err(PublishError::NoSharedMemory(
                "iceoryx2 failed: see its message above".to_owned(),
            )),
        }
    }

    /// Publishes a tick.
    pub fn record(&mut self, record: &RecordOf<C>) {
        self.put(Item::Record(*record));
    }

    /// Publishes an event.
    pub fn event(&mut self, event: Event) {
        self.put(Item::Event(event));
    }

    /// Publishes information about the daemon; before this, no program can
    /// watch.
    pub fn describe(&mut self, info: Info) {
        let record_bytes = (words::<RecordOf<C>>() * size_of::<u64>()) as u32;
        self.put(Item::Info(Info {
            record_bytes,
            ..info
        }));
    }

    /// Sets the state of recording, for the next status.
    pub fn recorder(&mut self, status: RecorderStatus) {
        self.put(Item::Recorder(status));
    }

    /// The next command from another program, if there is one. Give each an
    /// [`answer`](Self::answer).
    pub fn next_command(&mut self) -> Option<PendingCommand> {
        self.commands.as_ref()?.commands.try_recv().ok()
    }

    /// Answers a command.
    pub fn answer(&mut self, id: u64, verdict: Verdict) {
        if let Some(ends) = &self.commands {
            // There is room for the answers to all queued commands. If the
            // thread has ended, no program waits.
            let _ = ends.verdicts.try_send((id, verdict));
        }
    }

    /// Wakes the publishing thread: messages are published now and not within
    /// the next 20 ms.
    pub fn flush(&self) {
        self.thread.thread().unpark();
    }

    /// A new failure, or its end, as text; none if there is nothing new.
    pub fn poll(&mut self) -> Option<String> {
        if let Ok(text) = self.texts.try_recv() {
            return Some(text);
        }
        if self.ring.is_abandoned() && !self.over {
            self.over = true;
            return Some("live telemetry has failed: no program can watch any more".to_owned());
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
        // The thread finds the ring abandoned; what is in it is still
        // published.
        let (ring, _) = RingBuffer::new(1);
        drop(std::mem::replace(&mut self.ring, ring));
        self.flush();
        thread::wait(&self.thread, PATIENCE);
    }
}
