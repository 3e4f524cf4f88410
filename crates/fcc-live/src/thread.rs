//! The publishing thread.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::SyncSender;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::PortFactory;
use iceoryx2::sample_mut::SampleMut;
use nix::time::{ClockId, clock_gettime};
use rtrb::Consumer;

use super::change_limit::ChangeLimit;
use super::command::{CommandServer, Rings};
use super::item::Item;
use super::marks::Marks;
use super::place::Place;
use super::services::{self, Access, COLUMNS, EVENT, INFO, Out, RECORD, STATUS, Service};
use super::space;
use super::{Event, Info, PublishError, Status};
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
const LOOK_EVERY: Duration = Duration::from_millis(10);
/// Interval of checking the files, which takes some 30 us.
const CHECK_EVERY: Duration = Duration::from_millis(50);
/// Records in a row that cannot be published: shared memory was damaged.
const MOST_FAILURES: u32 = 20;

/// What is published, and how.
#[derive(Clone, Debug)]
pub(super) struct Order {
    /// The daemon's name.
    pub(super) instance: Instance,
    /// Items that may wait.
    pub(super) waiting: usize,
    /// The identifier of the first command; none if no commands are taken.
    pub(super) first_command: Option<u64>,
}

/// What the thread tells without waiting.
#[derive(Default, Debug)]
pub(super) struct Progress {
    /// Increases.
    pub(super) beats: AtomicU64,
    /// Records that could not be published.
    pub(super) not_published: AtomicU64,
    /// Records that were lost before the thread.
    pub(super) not_taken: AtomicU64,
}

impl Progress {
    /// Records that are not published.
    pub(super) fn all_not_published(&self) -> u64 {
        self.not_published.load(Ordering::Relaxed) + self.not_taken.load(Ordering::Relaxed)
    }
}

/// Whether publishing began.
pub(super) type Started = Result<(), PublishError>;

/// Publishes what comes through the ring until the ring is abandoned, and
/// receives commands if there are rings for them.
pub(super) fn publish<C: Telemetry>(
    order: &Order,
    commands: Option<Rings>,
    mut items: Consumer<Item<C>>,
    progress: &Progress,
    started: &SyncSender<Started>,
    reports: &SyncSender<String>,
) {
    let columns = RecordDescription::of::<RecordOf<C>>();
    let mut thread = match Publishing::open(&order.instance, &columns, commands) {
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
    let mut next_check = Instant::now();
    loop {
        // In this order: the last messages in the ring are published, too.
        let over = items.is_abandoned();
        if let Some(words) = thread.look_for_room() {
            // Full only if the daemon does not read its messages.
            let _ = reports.try_send(words);
        }
        while let Ok(item) = items.pop() {
            thread.take(&item, progress);
        }
        if over {
            thread.close();
            return;
        }
        if next_check <= Instant::now() {
            next_check = Instant::now() + CHECK_EVERY;
            if thread.is_damaged() {
                // Nothing of it is touched any more.
                std::mem::forget(thread);
                return;
            }
        }
        thread.connect_watchers();
        thread.take_commands();
        progress.beats.fetch_add(1, Ordering::Relaxed);
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
    /// Of the files that every watcher needs.
    marks: Marks,
    // Dropped last: they clean up after the others.
    access: Access,
    place: Place,
}

impl Ports {
    fn open(instance: &Instance, described: &RecordDescription) -> Result<Self, PublishError> {
        let place = Place::take(instance)?;
        let root = place.root().as_path();
        if let Some(words) = space::too_little(root, space::NEEDED_BYTES) {
            return Err(PublishError::NoSharedMemory(words));
        }
        let access = services::access(place.root()).map_err(PublishError::NoSharedMemory)?;
        let (_, infos) = INFO.publish(&access, instance)?;
        let words = described.row_bytes / size_of::<u64>();
        let (service, records) = RECORD.publish_slices(&access, instance, words)?;
        let columns = publish_columns(&access, instance, described)?;
        let (_, events) = EVENT.publish(&access, instance)?;
        let (_, statuses) = STATUS.publish(&access, instance)?;
        space::allocate_all_in(root).map_err(PublishError::NoSharedMemory)?;
        Ok(Self {
            columns,
            records,
            words,
            service,
            events,
            statuses,
            infos,
            marks: Marks::default(),
            access,
            place,
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

    /// All services are complete: other programs may find them.
    fn announce(&mut self) -> Result<(), PublishError> {
        self.place.announce()?;
        self.marks = Marks::of(self.place.root());
        Ok(())
    }

    /// Whether somebody has removed or changed the files.
    fn is_changed(&self) -> bool {
        !self.place.is_found() || self.marks.differ()
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
    /// Records in a row that could not be published.
    failures: u32,
    paused: bool,
    room: ChangeLimit,
}

impl Publishing {
    fn open(
        instance: &Instance,
        described: &RecordDescription,
        commands: Option<Rings>,
    ) -> Result<Self, PublishError> {
        let mut ports = Ports::open(instance, described)?;
        let desk = commands
            .map(|rings| CommandServer::open(&ports.access, instance, rings))
            .transpose()?;
        ports.announce()?;
        Ok(Self {
            desk,
            ports,
            failures: 0,
            paused: false,
            room: ChangeLimit::default(),
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
    /// changes. Another user's program can change it again and again.
    fn look_for_room(&mut self) -> Option<String> {
        let root = self.ports.place.root().as_path();
        let too_little = space::too_little(root, space::LEAST_BYTES);
        let was_paused = std::mem::replace(&mut self.paused, too_little.is_some());
        let change = match too_little {
            Some(words) if !was_paused => Some(format!("live telemetry is paused: {words}")),
            None if was_paused => Some("live telemetry continues: there is space again".to_owned()),
            _ => None,
        };
        self.room.step(Instant::now(), change)
    }

    fn take<C: Telemetry>(&mut self, item: &Item<C>, progress: &Progress) {
        match item {
            Item::Record(record) => {
                let was_sent = !self.paused && self.ports.send(record);
                let not_published = &progress.not_published;
                not_published.fetch_add(u64::from(!was_sent), Ordering::Relaxed);
                let has_failed = !was_sent && !self.paused;
                self.failures = if has_failed { self.failures + 1 } else { 0 };
            }
            Item::Event(event) => {
                if !self.paused {
                    // A failure to publish cannot be reported to watchers.
                    let _ = self.ports.events.send_copy(*event);
                }
            }
            Item::Info(info) => {
                if !self.paused {
                    let _ = self.ports.infos.send_copy(*info);
                }
            }
            Item::Status(status) => self.publish_status(status, progress),
        }
    }

    /// Connects new watchers, and sends them the history: in the order that
    /// they rely on.
    fn connect_watchers(&self) {
        if !self.paused {
            let _ = self.ports.infos.update_connections();
            let _ = self.ports.records.update_connections();
            let _ = self.ports.events.update_connections();
            let _ = self.ports.statuses.update_connections();
            let _ = self.ports.columns.update_connections();
        }
    }

    /// Publishes the status, completed by what is known here.
    fn publish_status(&mut self, status: &Status, progress: &Progress) {
        if self.paused {
            return;
        }
        // A killed watcher still occupies a place.
        self.ports.access.try_cleanup_dead_nodes();
        let status = Status {
            not_published: progress.all_not_published() + status.not_published,
            cpu_ns: thread_cpu_ns(),
            watchers: self.ports.service.dynamic_config().number_of_subscribers() as u32,
            ..*status
        };
        let _ = self.ports.statuses.send_copy(status);
    }

    /// Whether watchers no longer get what is published.
    fn is_damaged(&self) -> bool {
        self.failures >= MOST_FAILURES || self.ports.is_changed()
    }
}

fn thread_cpu_ns() -> u64 {
    clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID).map_or(0, |used| {
        used.tv_sec() as u64 * 1_000_000_000 + used.tv_nsec() as u64
    })
}
