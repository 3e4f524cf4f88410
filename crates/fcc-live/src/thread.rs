//! The publishing thread.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::SyncSender;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::PortFactory;
use iceoryx2::sample_mut::SampleMut;
use nix::time::{ClockId, clock_gettime};
use rtrb::Consumer;

use super::command::{CommandServer, Rings};
use super::item::Item;
use super::lateness::Lateness;
use super::place::Place;
use super::services::{self, Access, COLUMNS, EVENT, INFO, Out, RECORD, STATUS, Service};
use super::space;
use super::{Event, Info, PublishError, RecorderStatus, Status};
use fcc_core::framework::RecordOf;
use fcc_core::framework::schema::Schema;
use fcc_telemetry::schema::{RecordDescription, write_words};
use fcc_telemetry::{Instance, Telemetry};

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
    let columns = RecordDescription::of::<RecordOf<C>>();
    let mut thread = match Publishing::open(instance, &columns, commands) {
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
            if !over && thread.ports.is_removed() {
                let (again, words) = thread.publish_again(instance, &columns);
                let _ = reports.try_send(words);
                let Some(again) = again else {
                    return;
                };
                thread = again;
            }
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

/// The services of a daemon, and this process' access to them.
struct Ports {
    columns: Out<[u8]>,
    records: Out<[u64]>,
    /// Of a record.
    words: usize,
    service: Service<[u64]>,
    events: Out<Event>,
    statuses: Out<Status>,
    infos: Out<Info>,
    /// Files that every watcher needs.
    files: Vec<PathBuf>,
    // Dropped last: it cleans up after the others.
    access: Access,
}

impl Ports {
    fn open(instance: &Instance, described: &RecordDescription) -> Result<Self, PublishError> {
        if let Some(words) = space::too_little(space::NEEDED_BYTES) {
            return Err(PublishError::NoSharedMemory(words));
        }
        let access = services::access().map_err(PublishError::NoSharedMemory)?;
        // First, because its layout never changes: a name that is taken is
        // found here.
        let (info, infos) = INFO.publish(&access, instance)?;
        let words = described.row_bytes / size_of::<u64>();
        let (service, records) = RECORD.publish_slices(&access, instance, words)?;
        let columns = publish_columns(&access, instance, described)?;
        let (_, events) = EVENT.publish(&access, instance)?;
        let (_, statuses) = STATUS.publish(&access, instance)?;
        let names = [
            info.service_hash().to_string(),
            records.id().value().to_string(),
        ];
        Ok(Self {
            columns,
            records,
            words,
            service,
            events,
            statuses,
            infos,
            files: Place::of_this_user().files_of(&names),
            access,
        })
    }

    /// Publishes a record; whether that was possible.
    fn send(&self, record: &impl Schema) -> bool {
        let loaned = self.records.loan_slice(self.words);
        loaned.is_ok_and(|mut sample| {
            write_words(record, sample.payload_mut());
            sample.send().is_ok()
        })
    }

    /// Whether somebody has removed the files, so that no program can watch.
    fn is_removed(&self) -> bool {
        self.files.iter().any(|file| !file.exists())
    }
}

/// Publishes the columns; who watches later finds them, too.
fn publish_columns(
    access: &Access,
    instance: &Instance,
    described: &RecordDescription,
) -> Result<Out<[u8]>, PublishError> {
    let json = described.to_json();
    let (_, columns) = COLUMNS.publish_slices(access, instance, json.len())?;
    let sent = columns
        .loan_slice_uninit(json.len())
        .map(|sample| sample.write_from_slice(json.as_bytes()))
        .map(SampleMut::send);
    match sent {
        Ok(Ok(_)) => Ok(columns),
        Ok(Err(error)) => Err(PublishError::NoSharedMemory(services::explained(&error))),
        Err(error) => Err(PublishError::NoSharedMemory(services::explained(&error))),
    }
}

struct Publishing {
    desk: Option<CommandServer>,
    ports: Ports,
    info: Option<Info>,
    lateness: Lateness,
    recorder: RecorderStatus,
    time_ns: i64,
    not_published: u64,
    paused: bool,
}

impl Publishing {
    fn open(
        instance: &Instance,
        described: &RecordDescription,
        commands: Option<Rings>,
    ) -> Result<Self, PublishError> {
        let ports = Ports::open(instance, described)?;
        let desk = commands
            .map(|rings| CommandServer::open(&ports.access, instance, rings))
            .transpose()?;
        Ok(Self {
            desk,
            ports,
            info: None,
            lateness: Lateness::new(),
            recorder: RecorderStatus::default(),
            time_ns: i64::MIN,
            not_published: 0,
            paused: false,
        })
    }

    /// Publishes under the same name after the files were removed, and says how
    /// that went.
    fn publish_again(
        self,
        instance: &Instance,
        described: &RecordDescription,
    ) -> (Option<Self>, String) {
        const REMOVED: &str = "the files of live telemetry in /dev/shm were removed";
        let rings = self.desk.map(CommandServer::into_rings);
        // They would remove the new ones of the same names.
        drop(self.ports);
        match Self::open(instance, described, rings) {
            Ok(Self { desk, ports, .. }) => {
                if let Some(info) = self.info {
                    let _ = ports.infos.send_copy(info);
                }
                let again = Self {
                    desk,
                    ports,
                    ..self
                };
                (Some(again), format!("{REMOVED}: it is published again"))
            }
            Err(error) => (
                None,
                format!("{REMOVED}, and it cannot be published again: {error}"),
            ),
        }
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

    fn take<C: Telemetry>(&mut self, item: &Item<C>) {
        match item {
            Item::Record(record) => {
                self.lateness.take(&record.tick);
                self.time_ns = record.tick.woke.as_nanos();
                if self.paused || !self.ports.send(record) {
                    self.not_published += 1;
                }
            }
            Item::Event(event) => {
                if !self.paused {
                    // A failure to publish cannot be reported to watchers.
                    let _ = self.ports.events.send_copy(*event);
                }
            }
            Item::Info(info) => {
                self.info = Some(*info);
                if !self.paused {
                    let _ = self.ports.infos.send_copy(*info);
                }
            }
            Item::Recorder(status) => self.recorder = *status,
        }
    }

    /// Connects new watchers, and sends them the history.
    fn connect_watchers(&self) {
        if !self.paused {
            let _ = self.ports.infos.update_connections();
            let _ = self.ports.columns.update_connections();
            let _ = self.ports.records.update_connections();
            let _ = self.ports.events.update_connections();
            let _ = self.ports.statuses.update_connections();
        }
    }

    fn publish_status(&mut self, left_out: u64) {
        if self.paused {
            return;
        }
        // A killed watcher still occupies a place.
        self.ports.access.try_cleanup_dead_nodes();
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
            watchers: self.ports.service.dynamic_config().number_of_subscribers() as u32,
            recorder_state: self.recorder.state as u32,
            recorded: self.recorder.recorded,
            not_recorded: self.recorder.not_recorded,
            recording_bytes: self.recorder.bytes,
            recording: self.recorder.name,
        };
        let _ = self.ports.statuses.send_copy(status);
    }
}

fn thread_cpu_ns() -> u64 {
    clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID).map_or(0, |used| {
        used.tv_sec() as u64 * 1_000_000_000 + used.tv_nsec() as u64
    })
}
