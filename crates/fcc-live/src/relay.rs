//! The process that publishes for a daemon: takes its messages from a socket,
//! and publishes them in a thread.

use std::os::fd::AsFd;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use fcc_core::framework::RecordOf;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::resource::{Resource, setrlimit};
use nix::time::{ClockId, clock_gettime};

use super::PublishError;
use super::item::Item;
use super::message::{self, Encoded, FromPublisher, Received, ToPublisher, put, take};
use super::offered::is_offered;
use super::publishing_thread::PublishingThread;
use super::thread::Order;
use fcc_telemetry::schema::read_words;
use fcc_telemetry::{Instance, Telemetry};

/// How long it waits for messages.
const WAIT_MS: u8 = 20;
/// Interval of its signs of life.
const ALIVE_EVERY: Duration = Duration::from_millis(100);
/// Interval of trying what a new watcher does.
const TRY_EVERY: Duration = Duration::from_millis(250);
/// The next attempt after one that failed.
const TRY_AGAIN_AFTER: Duration = Duration::from_millis(100);
/// Attempts in a row that fail: shared memory was damaged.
const MOST_FAILURES: u32 = 2;
/// The thread serves a new watcher each time that it makes progress: one that
/// gets nothing after so many times gets nothing any more. The first may have
/// begun before it watched.
const SERVED_AFTER: u64 = 3;
/// A thread that makes no progress in so much of the processor's time reads
/// damaged memory without end. One that waits, or gets no time on the processor,
/// is waited for: the daemon ends this process if that lasts.
const SPINS_FOR: Duration = Duration::from_millis(150);

/// Why it ended before the daemon did.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum RelayError {
    /// Nothing, or something else, came from the daemon.
    #[error("it is started by fccd itself, with its input")]
    Nothing,
    /// Publishing did not begin.
    #[error(transparent)]
    Publish(#[from] PublishError),
    /// Shared memory was removed, changed or damaged.
    #[error("shared memory was removed, changed or damaged")]
    Damaged,
}

/// Publishes what a daemon sends over this socket, until it closes it: the
/// other end is [`PublisherOf::start_process`](super::PublisherOf::start_process).
/// After an error the process must end without further use of shared memory.
///
/// # Errors
/// When publishing does not begin, or cannot go on: the daemon starts another
/// process.
pub fn run_publisher<C: Telemetry, S: AsFd>(socket: &S) -> Result<(), RelayError> {
    // What other programs do to shared memory is no fault of this one.
    let _ = setrlimit(Resource::RLIMIT_CORE, 0, 0);
    let mut encoded = Encoded::default();
    let mut room = message::room();
    let order = begin(socket, &mut room).ok_or(RelayError::Nothing)?;
    let instance = order.instance.clone();
    let mut thread = match PublishingThread::<C>::start(order) {
        Ok(thread) => thread,
        Err(error) => {
            let told = FromPublisher::Started(Err(error.clone()));
            put(socket, encoded.other(&told));
            return Err(error.into());
        }
    };
    put(socket, encoded.other(&FromPublisher::Started(Ok(()))));
    let mut own = Own::new(&instance);
    loop {
        wait(socket);
        let is_open = pass_on(socket, &mut room, &mut thread, &mut own);
        thread.wake();
        if !is_open {
            return Ok(());
        }
        while let Some(command) = thread.next_command() {
            put(socket, encoded.other(&FromPublisher::Command(command)));
        }
        let ended = thread.has_ended();
        while let Some(text) = thread.text() {
            put(socket, encoded.other(&FromPublisher::Text(text)));
        }
        if ended || own.is_damaged(&thread) {
            // Its ends would touch shared memory.
            std::mem::forget(thread);
            return Err(RelayError::Damaged);
        }
        if own.has_progress(&thread) {
            let alive = FromPublisher::Alive(thread.progress().all_not_published());
            put(socket, encoded.other(&alive));
        }
    }
}

fn wait(socket: &impl AsFd) {
    let mut ready = [PollFd::new(socket.as_fd(), PollFlags::POLLIN)];
    let _ = poll(&mut ready, PollTimeout::from(WAIT_MS));
}

/// The first message.
fn begin(socket: &impl AsFd, room: &mut [u8]) -> Option<Order> {
    loop {
        match take(socket, room) {
            Received::Other(ToPublisher::Begin {
                instance,
                takes_commands,
                first_command,
                waiting,
            }) => {
                return Some(Order {
                    instance,
                    waiting,
                    first_command: takes_commands.then_some(first_command),
                });
            }
            Received::Nothing => wait(socket),
            _ => return None,
        }
    }
}

/// Passes all messages to the thread; whether the daemon is still there.
fn pass_on<C: Telemetry>(
    socket: &impl AsFd,
    room: &mut [u8],
    thread: &mut PublishingThread<C>,
    own: &mut Own,
) -> bool {
    loop {
        match take(socket, room) {
            Received::Record(words) => {
                let record = read_words::<RecordOf<C>>(&words);
                let was_taken = record.is_ok_and(|record| thread.put(Item::Record(record)));
                if !was_taken {
                    let lost = &thread.progress().not_taken;
                    lost.fetch_add(1, Ordering::Relaxed);
                }
            }
            Received::Other(ToPublisher::Event(event)) => {
                thread.put(Item::Event(event));
            }
            Received::Other(ToPublisher::Info(info)) => {
                own.is_described = true;
                thread.put(Item::Info(info));
            }
            Received::Other(ToPublisher::Status(status)) => {
                thread.put(Item::Status(status));
            }
            Received::Other(ToPublisher::Answer(id, verdict)) => thread.answer(id, verdict),
            Received::Other(ToPublisher::Begin { .. }) | Received::Invalid => {}
            Received::Nothing => return true,
            Received::Closed => return false,
        }
    }
}

/// What this process checks of itself.
struct Own {
    instance: Instance,
    /// Before, no program can watch.
    is_described: bool,
    next_try: Instant,
    failures: u32,
    beats: u64,
    next_sign: Instant,
}

impl Own {
    fn new(instance: &Instance) -> Self {
        let now = Instant::now();
        Self {
            instance: instance.clone(),
            is_described: false,
            next_try: now,
            failures: 0,
            beats: 0,
            next_sign: now,
        }
    }

    /// Whether a new watcher would find nothing. Finds what other programs
    /// write through their mappings, unless it ends this process.
    fn is_damaged<C: Telemetry>(&mut self, thread: &PublishingThread<C>) -> bool {
        let now = Instant::now();
        if self.is_described && now >= self.next_try {
            let beats = || thread.progress().beats.load(Ordering::Relaxed);
            let mut last = None;
            let goes_on = || {
                thread.wake();
                let (served, began) =
                    *last.get_or_insert_with(|| (beats() + SERVED_AFTER, cpu_time()));
                beats() < served && cpu_time().saturating_sub(began) < SPINS_FOR
            };
            (self.failures, self.next_try) = if is_offered(&self.instance, goes_on) {
                (0, now + TRY_EVERY)
            } else {
                (self.failures + 1, now + TRY_AGAIN_AFTER)
            };
        }
        self.failures >= MOST_FAILURES
    }

    /// Whether the thread has made progress since the last sign of life, and
    /// the next one is due.
    fn has_progress<C: Telemetry>(&mut self, thread: &PublishingThread<C>) -> bool {
        let now = Instant::now();
        let beats = thread.progress().beats.load(Ordering::Relaxed);
        if now < self.next_sign || beats == self.beats {
            return false;
        }
        (self.beats, self.next_sign) = (beats, now + ALIVE_EVERY);
        true
    }
}

/// The processor's time that all threads of this process have used.
fn cpu_time() -> Duration {
    clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID).map_or(Duration::ZERO, Duration::from)
}
