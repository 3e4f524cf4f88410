//! The thread that publishes, as seen by who hands it messages.

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread::JoinHandle;
use std::time::Duration;

use rtrb::{Producer, RingBuffer};

use super::PublishError;
use super::command::{CommandServer, Ends, PendingCommand, Verdict};
use super::item::Item;
use super::thread::{self, Order, Progress, Started};
use fcc_telemetry::{Telemetry, not_started};

/// How long the start and the end of publishing may take. A flight waits no
/// longer.
pub(super) const PATIENCE: Duration = Duration::from_secs(2);

/// A running thread that publishes. Dropping it ends the services.
#[derive(Debug)]
pub(super) struct PublishingThread<C: Telemetry> {
    ring: Producer<Item<C>>,
    progress: Arc<Progress>,
    thread: JoinHandle<()>,
    texts: Receiver<String>,
    commands: Option<Ends>,
}

impl<C: Telemetry> PublishingThread<C> {
    /// Starts it, and waits until it publishes.
    pub(super) fn start(order: Order) -> Result<Self, PublishError> {
        let (ring, items) = RingBuffer::new(order.waiting.max(1));
        let (started, start) = mpsc::sync_channel::<Started>(1);
        // More than the thread ever reports between two polls.
        let (reports, texts) = mpsc::sync_channel(16);
        let (commands, rings) = order.first_command.map(CommandServer::rings).unzip();
        let progress = Arc::<Progress>::default();
        let told = Arc::clone(&progress);
        let thread = std::thread::Builder::new()
            .name(thread::NAME.to_owned())
            .stack_size(thread::STACK_BYTES)
            .spawn(move || thread::publish(&order, rings, items, &told, &started, &reports))
            .map_err(|error| PublishError::NoSharedMemory(not_started(error).to_string()))?;
        match start.recv_timeout(PATIENCE) {
            Ok(Ok(())) => Ok(Self {
                ring,
                progress,
                thread,
                texts,
                commands,
            }),
            Ok(Err(error)) => Err(error),
            Err(RecvTimeoutError::Timeout) => {
                Err(PublishError::NoSharedMemory(NO_RESPONSE.to_owned()))
            }
            Err(RecvTimeoutError::Disconnected) => Err(PublishError::NoSharedMemory(
                "iceoryx2 failed: see its message above".to_owned(),
            )),
        }
    }

    /// Whether there was room.
    pub(super) fn put(&mut self, item: Item<C>) -> bool {
        self.ring.push(item).is_ok()
    }

    /// What was put is published now and not within the next 10 ms.
    pub(super) fn wake(&self) {
        self.thread.thread().unpark();
    }

    pub(super) fn next_command(&self) -> Option<PendingCommand> {
        self.commands.as_ref()?.commands.try_recv().ok()
    }

    pub(super) fn answer(&self, id: u64, verdict: Verdict) {
        if let Some(ends) = &self.commands {
            // There is room for the answers to all queued commands. If the
            // thread has ended, no program waits.
            let _ = ends.verdicts.try_send((id, verdict));
        }
    }

    /// A new failure, or its end, as text; none if there is nothing new.
    pub(super) fn text(&self) -> Option<String> {
        self.texts.try_recv().ok()
    }

    /// Whether the thread has ended.
    pub(super) fn has_ended(&self) -> bool {
        self.ring.is_abandoned()
    }

    pub(super) fn progress(&self) -> &Progress {
        &self.progress
    }
}

/// For a publisher that does not begin in time.
pub(super) const NO_RESPONSE: &str =
    "it does not respond within 2 s: the machine is overloaded, or a program stops it";

impl<C: Telemetry> Drop for PublishingThread<C> {
    fn drop(&mut self) {
        // The thread finds the ring abandoned; what is in it is still
        // published.
        let (ring, _) = RingBuffer::new(1);
        drop(std::mem::replace(&mut self.ring, ring));
        self.wake();
        thread::wait(&self.thread, PATIENCE);
    }
}
