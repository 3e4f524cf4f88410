//! The publishing thread.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::SyncSender;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::PortFactory;
use nix::time::{ClockId, clock_gettime};
use rtrb::Consumer;

use super::command::{CommandServer, Rings};
use super::item::Item;
use super::lateness::Lateness;
use super::record::Published;
use super::services::{self, Access, EVENT, INFO, Out, RECORD, STATUS, Service};
use super::space;
use super::{Event, Info, PublishError, RecorderStatus, Status};
use fcc_telemetry::{Instance, RecordWords as _, Telemetry};

/// The thread's name, as `top -H` shows it.
pub(super) const NAME: &str = "fcc-live";

/// Size of the thread's stack. With locked memory all of it is resident, so it is
/// kept small; unoptimised code needs larger stack frames.
pub(super) const STACK_BYTES: usize = if cfg!(debug_assertions) {
    4 << 20
} else {
    512 << 10
};

/// How long it sleeps unless woken.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// Interval of the status and of cleaning up after killed watchers.
const STATUS_EVERY: Duration = Duration::from_secs(1);

/// Whether publishing began.
pub(super) type Started = Result<(), PublishError>;

/// Publishes what comes through the ring until the ring is abandoned, and
/// receives commands if there are rings for them.
pub(super) fn publish<C: Telemetry>(
    instance: &Instance,
    commands: Option<Rings>,
    mut items: Consumer<Item<C>>,
    left_out: &AtomicU64,
    started: &SyncSender<Started>,
    reports: &SyncSender<String>,
) {
    let mut thread = match Publishing::<C>::open(instance, commands) {
        Ok(thread) => thread,
        Err(error) => {
            // The daemon waits for this, unless it has given up.
            let _ = started.send(Err(error));
            return;
        }
    };
    if started.send(Ok(())).is_err() {
        return;
    }
    let mut next_status = Instant::now();
    loop {
        // In this order: the last messages in the ring are published, too.
        let over = items.is_abandoned();
        if let Some(words) = thread.look_for_room() {
            // Full only if the daemon does not read its messages.
            let _ = reports.try_send(words);
        }
        while let Ok(item) = items.pop() {
            thread.take(&item);
        }
        if next_status <= Instant::now() || over {
            // From now on: missed intervals are not made up for after a stall.
            next_status = Instant::now() + STATUS_EVERY;
            thread.publish_status(left_out.load(Ordering::Relaxed));
        }
        if over {
            thread.close();
            return;
        }
        thread.connect_watchers();
        thread.take_commands();
        std::thread::park_timeout(LOOK_EVERY);
    }
}

/// Waits for a thread to end, for a limited time.
pub(super) fn wait(thread: &JoinHandle<()>, at_most: Duration) {
    let deadline = Instant::now() + at_most;
    while !thread.is_finished() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(2));
    }
}

struct Publishing<C: Telemetry> {
    desk: Option<CommandServer>,
    records: Out<Published<C>>,
    service: Service<Published<C>>,
    events: Out<Event>,
    statuses: Out<Status>,
    infos: Out<Info>,
    lateness: Lateness,
    recorder: RecorderStatus,
    time_ns: i64,
    not_published: u64,
    paused: bool,
    // Dropped last: it cleans up after the others.
    access: Access,
}

impl<C: Telemetry> Publishing<C> {
    fn open(instance: &Instance, commands: Option<Rings>) -> Result<Self, PublishError> {
        if let Some(words) = space::too_little(space::NEEDED_BYTES) {
            return Err(PublishError::NoSharedMemory(words));
        }
        let access = services::access().map_err(PublishError::NoSharedMemory)?;
        // First, because its layout never changes: a name that is taken is
        // found here.
        let (_, infos) = INFO.publish(&access, instance)?;
        let (service, records) = RECORD.publish(&access, instance)?;
        let (_, events) = EVENT.publish(&access, instance)?;
        let (_, statuses) = STATUS.publish(&access, instance)?;
        let desk = commands
            .map(|rings| CommandServer::open(&access, instance, rings))
            .transpose()?;
        Ok(Self {
            desk,
            records,
            service,
            events,
            statuses,
            infos,
            lateness: Lateness::new(),
            recorder: RecorderStatus::default(),
            time_ns: i64::MIN,
            not_published: 0,
            paused: false,
            access,
        })
    }

    /// Receives and answers commands; they wait while shared memory is nearly
    /// full.
    fn take_commands(&mut self) {
        if let Some(desk) = self.desk.as_mut().filter(|_| !self.paused) {
            desk.serve();
        }
    }

    /// No more commands or answers will come.
    fn close(&mut self) {
        if let Some(desk) = self.desk.take() {
            desk.close();
        }
    }

    /// Pauses while shared memory is nearly full; returns a text when that
    /// changes.
    fn look_for_room(&mut self) -> Option<String> {
        let too_little = space::too_little(space::LEAST_BYTES);
        let was_paused = std::mem::replace(&mut self.paused, too_little.is_some());
        match too_little {
            Some(words) if !was_paused => Some(format!("live telemetry is paused: {words}")),
            None if was_paused => Some("live telemetry continues: there is space again".to_owned()),
            _ => None,
        }
    }

    fn take(&mut self, item: &Item<C>) {
        match item {
            Item::Record(record) => {
                self.lateness.take(&record.tick);
                self.time_ns = record.tick.woke.as_nanos();
                if self.paused
                    || self
                        .records
                        .send_copy(Published(C::Words::of_record(record)))
                        .is_err()
                {
                    self.not_published += 1;
                }
            }
            Item::Event(event) => {
                if !self.paused {
                    // A failure to publish cannot be reported to watchers.
                    let _ = self.events.send_copy(*event);
                }
            }
            Item::Info(info) => {
                if !self.paused {
                    let _ = self.infos.send_copy(*info);
                }
            }
            Item::Recorder(status) => self.recorder = *status,
        }
    }

    /// Connects new watchers, and sends them the history.
    fn connect_watchers(&self) {
        if !self.paused {
            let _ = self.infos.update_connections();
            let _ = self.records.update_connections();
            let _ = self.events.update_connections();
            let _ = self.statuses.update_connections();
        }
    }

    fn publish_status(&mut self, left_out: u64) {
        if self.paused {
            return;
        }
        // A killed watcher still occupies a place.
        self.access.try_cleanup_dead_nodes();
        let status = Status {
            time_ns: self.time_ns,
            ticks: self.lateness.ticks,
            missed: self.lateness.missed,
            lateness_p50_ns: self.lateness.quantile_ns(0.5),
            lateness_p99_ns: self.lateness.quantile_ns(0.99),
            lateness_p99_9_ns: self.lateness.quantile_ns(0.999),
            lateness_max_ns: self.lateness.max_ns,
            lateness_counts: self.lateness.counts,
            not_published: self.not_published + left_out,
            cpu_ns: thread_cpu_ns(),
            watchers: self.service.dynamic_config().number_of_subscribers() as u32,
            recorder_state: self.recorder.state as u32,
            recorded: self.recorder.recorded,
            not_recorded: self.recorder.not_recorded,
            recording_bytes: self.recorder.bytes,
            recording: self.recorder.name,
        };
        let _ = self.statuses.send_copy(status);
    }
}

fn thread_cpu_ns() -> u64 {
    clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID).map_or(0, |used| {
        used.tv_sec() as u64 * 1_000_000_000 + used.tv_nsec() as u64
    })
}
