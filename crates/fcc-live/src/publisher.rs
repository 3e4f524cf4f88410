//! The daemon's side: takes messages to publish, without waiting.

use std::time::{Duration, Instant};

use fcc_core::framework::RecordOf;

use super::command::{PendingCommand, Verdict};
use super::item::Item;
use super::lateness::Lateness;
use super::publisher_process::{PublisherProcess, StartPublisher};
use super::publishing_thread::PublishingThread;
use super::thread::Order;
use super::{Event, Info, PublishError, RecorderStatus, Status};
use fcc_telemetry::schema::words;
use fcc_telemetry::{Instance, Telemetry};

/// Interval of the status.
const STATUS_EVERY: Duration = Duration::from_secs(1);

/// Publishes a flight.
#[cfg(feature = "flight")]
pub type Publisher = PublisherOf<fcc_fixed_wing::Autopilot>;

/// Publishes the messages of a loop.
///
/// Messages go to a thread of this process, or to another process, which does
/// it: what other programs do to shared memory then cannot harm this one.
/// Neither is waited for: what it does not take in time is dropped and counted.
/// Dropping a publisher ends the services.
#[derive(Debug)]
pub struct PublisherOf<C: Telemetry> {
    carrier: Carrier<C>,
    lateness: Lateness,
    recorder: RecorderStatus,
    time_ns: i64,
    /// Dropped records.
    left_out: u64,
    next_status: Instant,
    over: bool,
}

/// Who publishes.
#[derive(Debug)]
enum Carrier<C: Telemetry> {
    Thread(PublishingThread<C>),
    Process(Box<PublisherProcess>),
}

impl<C: Telemetry> PublisherOf<C> {
    /// Starts to publish as `instance` in a thread of this process, without
    /// commands. Up to `waiting` records
    /// wait to be published: two seconds of them are enough, because a watcher
    /// that joins or leaves may delay the publishing thread by one.
    ///
    /// A program of the same user that truncates the shared memory ends this
    /// process: a flight publishes in [another](Self::start_process).
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
        PublishingThread::start(Order {
            instance: instance.clone(),
            waiting,
            first_command: takes_commands.then_some(0),
        })
        .map(|thread| Self::by(Carrier::Thread(thread)))
    }

    /// Starts to publish in another process, which runs
    /// [`run_publisher`](super::run_publisher) with its standard input. If that
    /// process ends it is started again.
    ///
    /// # Errors
    /// As [`start`](Self::start), and when the process cannot be started.
    pub fn start_process(
        program: StartPublisher,
        instance: &Instance,
        waiting: usize,
        takes_commands: bool,
    ) -> Result<Self, PublishError> {
        PublisherProcess::start(program, instance, waiting, takes_commands)
            .map(|process| Self::by(Carrier::Process(Box::new(process))))
    }

    fn by(carrier: Carrier<C>) -> Self {
        Self {
            carrier,
            lateness: Lateness::new(),
            recorder: RecorderStatus::default(),
            time_ns: i64::MIN,
            left_out: 0,
            next_status: Instant::now(),
            over: false,
        }
    }

    /// Publishes a tick.
    pub fn record(&mut self, record: &RecordOf<C>) {
        self.lateness.take(&record.tick);
        self.time_ns = record.tick.woke.as_nanos();
        let was_taken = match &mut self.carrier {
            Carrier::Thread(thread) => thread.put(Item::Record(*record)),
            Carrier::Process(process) => process.record(record),
        };
        self.left_out += u64::from(!was_taken);
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
        self.recorder = status;
    }

    /// The next command from another program, if there is one. Give each an
    /// [`answer`](Self::answer).
    pub fn next_command(&mut self) -> Option<PendingCommand> {
        match &mut self.carrier {
            Carrier::Thread(thread) => thread.next_command(),
            Carrier::Process(process) => process.next_command(),
        }
    }

    /// Answers a command.
    pub fn answer(&mut self, id: u64, verdict: Verdict) {
        match &mut self.carrier {
            Carrier::Thread(thread) => thread.answer(id, verdict),
            Carrier::Process(process) => process.answer(id, verdict),
        }
    }

    /// Messages are published now and not within the next 10 ms; and each second
    /// a status.
    pub fn flush(&mut self) {
        let now = Instant::now();
        if now >= self.next_status {
            // From now on: missed intervals are not made up for after a stall.
            self.next_status = now + STATUS_EVERY;
            self.put_status();
        }
        if let Carrier::Thread(thread) = &self.carrier {
            thread.wake();
        }
    }

    /// A new failure, or its end, as text; none if there is nothing new. Starts
    /// another process if it has ended: call it 50 times a second.
    pub fn poll(&mut self) -> Option<String> {
        match &mut self.carrier {
            Carrier::Thread(thread) => {
                if let Some(text) = thread.text() {
                    return Some(text);
                }
                if thread.has_ended() && !self.over {
                    self.over = true;
                    return Some(
                        "live telemetry has failed: no program can watch any more".to_owned(),
                    );
                }
                None
            }
            Carrier::Process(process) => process.poll(),
        }
    }

    fn put(&mut self, item: Item<C>) {
        match &mut self.carrier {
            Carrier::Thread(thread) => {
                thread.put(item);
            }
            Carrier::Process(process) => process.put(&item),
        }
    }

    fn put_status(&mut self) {
        let lost = match &self.carrier {
            Carrier::Thread(_) => 0,
            Carrier::Process(process) => process.lost(),
        };
        let (lateness, recorder) = (&self.lateness, &self.recorder);
        self.put(Item::Status(Status {
            time_ns: self.time_ns,
            ticks: lateness.ticks,
            missed: lateness.missed,
            lateness_p50_ns: lateness.quantile_ns(0.5),
            lateness_p99_ns: lateness.quantile_ns(0.99),
            lateness_p99_9_ns: lateness.quantile_ns(0.999),
            lateness_max_ns: lateness.max_ns,
            lateness_counts: lateness.counts,
            not_published: self.left_out.saturating_add(lost),
            recorder_state: recorder.state as u32,
            recorded: recorder.recorded,
            not_recorded: recorder.not_recorded,
            recording_bytes: recorder.bytes,
            recording: recorder.name,
            ..Status::default()
        }));
    }
}

impl<C: Telemetry> Drop for PublisherOf<C> {
    fn drop(&mut self) {
        self.put_status();
    }
}
