//! The reading side, for any plant.

use std::collections::VecDeque;
use std::fmt::Debug;
use std::path::Path;
use std::time::{Duration, Instant};

use iceoryx2::port::ReceiveError;
use iceoryx2::port::subscriber::{Subscriber, SubscriberCreateError};
use iceoryx2::prelude::{IceoryxSend, PortFactory, ZeroCopySend};

use super::connected::Connected;
use super::place::{FoundPlace, Presence, look};
use super::services::{self, Access, COLUMNS, EVENT, INFO, Ipc, RECORD, STATUS, Service};
use super::space;
use super::{EVENT_HISTORY, Event, Info, LAYOUT, Status, WatchError};
use fcc_telemetry::Instance;
use fcc_telemetry::schema::RecordDescription;

/// How long a daemon may take to publish its information: long enough for a
/// busy machine. A daemon that has ended is noticed at once.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);
const LOOK_EVERY: Duration = Duration::from_millis(5);

pub(super) type In<T> = Subscriber<Ipc, T, ()>;

/// How often it is checked, while nothing arrives, whether another process
/// publishes.
const CHECK_EVERY: Duration = Duration::from_millis(100);

/// How long a daemon that lives is waited for while nobody publishes for it.
const LIVES: Duration = Duration::from_secs(5);

/// Watches a loop of any plant on this machine, from this or another process:
/// each record is a row of words, whose columns the loop describes.
///
/// If the process that publishes for a daemon was ended and another one has
/// taken its place, the watcher continues with that.
#[derive(Debug)]
pub struct RowWatcher {
    instance: Instance,
    connected: Connected<Opened>,
    info: Info,
    columns: RecordDescription,
    checked: Instant,
    /// When somebody published by this name the last time it was looked.
    seen: Instant,
    /// The last events; so many of the next may be among them.
    last_events: VecDeque<Event>,
    repeats: usize,
}

/// The services.
#[derive(Debug)]
struct Opened {
    records: In<[u64]>,
    events: In<Event>,
    statuses: In<Status>,
    info: Info,
    columns: RecordDescription,
    // Dropped last: it cleans up after the others.
    _access: Access,
}

impl Opened {
    fn at(place: &FoundPlace, instance: &Instance) -> Result<Self, WatchError> {
        let root = place.root.as_path();
        if let Some(words) = space::too_little(root, space::WATCHER_BYTES) {
            return Err(WatchError::NoSharedMemory(words));
        }
        let access = services::access(&place.root).map_err(WatchError::NoSharedMemory)?;
        // Who publishes serves them in turn, each 10 ms: the information first, the
        // columns last. With the information subscribed to after the other three,
        // and the columns after it has arrived, all have arrived with the columns.
        // Those of another version have other names.
        let records = RECORD.watch_slices(&access, instance);
        let records = records.and_then(|service| subscribe(&service, instance));
        let events = EVENT.watch(&access, instance);
        let events = events.and_then(|service| subscribe(&service, instance));
        let statuses = STATUS.watch(&access, instance);
        let statuses = statuses.and_then(|service| subscribe(&service, instance));
        let info = read_info(&access, place, instance, PATIENCE)?;
        check_layout(&info, instance)?;
        let columns = COLUMNS.watch_slices::<u8>(&access, instance)?;
        let texts = subscribe(&columns, instance)?;
        let opened = Self {
            records: records?,
            events: events?,
            statuses: statuses?,
            columns: read_columns(&texts, &columns, place, instance)?,
            info,
            _access: access,
        };
        // So that using it cannot fail when there is no more.
        space::allocate_all_in(root).map_err(WatchError::NoSharedMemory)?;
        Ok(opened)
    }
}

impl RowWatcher {
    /// Starts to watch. The newest record, the newest status and up to 64 past
    /// events are available at once.
    ///
    /// # Errors
    /// When no daemon of this name runs here, it publishes in another layout,
    /// or the maximum number of programs is watching.
    pub fn open(instance: &Instance) -> Result<Self, WatchError> {
        let connected = Connected::open(instance, |place| Opened::at(place, instance))?;
        let opened = connected.ports()?;
        let (info, columns) = (opened.info, opened.columns.clone());
        let now = Instant::now();
        Ok(Self {
            instance: instance.clone(),
            connected,
            info,
            columns,
            checked: now,
            seen: now,
            last_events: VecDeque::with_capacity(EVENT_HISTORY),
            repeats: 0,
        })
    }

    /// The daemon's name.
    pub const fn instance(&self) -> &Instance {
        &self.instance
    }

    /// The daemon.
    pub const fn info(&self) -> &Info {
        &self.info
    }

    /// The columns of its records.
    pub const fn columns(&self) -> &RecordDescription {
        &self.columns
    }

    /// Reads the newest record not read yet; earlier ones are skipped.
    ///
    /// # Errors
    /// When it has another length, or shared memory fails.
    pub fn newest<T>(&mut self, read: impl FnOnce(&[u64]) -> T) -> Result<Option<T>, WatchError> {
        self.follow()?;
        let records = &self.connected.ports()?.records;
        let mut newest = None;
        while let Some(sample) = records.receive().map_err(failed)? {
            newest = Some(sample);
        }
        newest.map(|sample| self.row(&sample, read)).transpose()
    }

    /// Reads the next record, if there is one. A watcher that polls less often
    /// than each second at 1 kHz misses records: the ticks' numbers show it.
    ///
    /// # Errors
    /// When it has another length, or shared memory fails.
    pub fn next<T>(&mut self, read: impl FnOnce(&[u64]) -> T) -> Result<Option<T>, WatchError> {
        self.follow()?;
        let found = self.connected.ports()?.records.receive().map_err(failed)?;
        found.map(|sample| self.row(&sample, read)).transpose()
    }

    fn row<T>(&self, words: &[u64], read: impl FnOnce(&[u64]) -> T) -> Result<T, WatchError> {
        if size_of_val(words) != self.columns.row_bytes {
            return Err(WatchError::Damaged(self.instance.clone()));
        }
        Ok(read(words))
    }

    /// The next event; none if there is none yet.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn next_event(&mut self) -> Result<Option<Event>, WatchError> {
        self.follow()?;
        while let Some(event) = next(&self.connected.ports()?.events)? {
            let may_repeat = self.repeats > 0;
            self.repeats = self.repeats.saturating_sub(1);
            if may_repeat && self.last_events.contains(&event) {
                continue;
            }
            if self.last_events.len() == EVENT_HISTORY {
                self.last_events.pop_front();
            }
            self.last_events.push_back(event);
            return Ok(Some(event));
        }
        Ok(None)
    }

    /// The newest status not returned yet.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn latest_status(&mut self) -> Result<Option<Status>, WatchError> {
        self.follow()?;
        newest(&self.connected.ports()?.statuses)
    }

    /// Whether the daemon still publishes. It looks at files: call it only
    /// when no data has come for a while.
    pub fn is_alive(&mut self) -> bool {
        let is_ours = self.connected.ports().is_ok();
        is_ours && (self.is_here() || self.is_between())
    }

    /// From time to time, continues where another process publishes now.
    fn follow(&mut self) -> Result<(), WatchError> {
        self.connected.ports()?;
        if self.checked.elapsed() >= CHECK_EVERY {
            self.is_here();
        }
        Ok(())
    }

    /// Whether somebody publishes for the daemon, and is watched now.
    fn is_here(&mut self) -> bool {
        self.checked = Instant::now();
        let Presence::Here(place) = look(&self.instance) else {
            return false;
        };
        if place != self.connected.place {
            let Ok(opened) = Opened::at(&place, &self.instance) else {
                return false;
            };
            // Otherwise it is the next daemon of this name.
            if opened.info.process_id != self.info.process_id {
                return false;
            }
            self.info = opened.info;
            self.repeats = EVENT_HISTORY;
            self.connected = Connected::at(place, opened);
        }
        self.seen = Instant::now();
        true
    }

    /// Whether another process may publish soon: the daemon lives.
    fn is_between(&self) -> bool {
        let daemon = format!("/proc/{}", self.info.process_id);
        self.seen.elapsed() < LIVES && Path::new(&daemon).exists()
    }
}

/// Whether this program can read what the daemon publishes.
pub(super) fn check_layout(info: &Info, instance: &Instance) -> Result<(), WatchError> {
    if info.is_understood() {
        return Ok(());
    }
    Err(WatchError::OtherLayout {
        instance: instance.clone(),
        software: info.software.as_str().to_owned(),
        layout: info.layout,
        own: LAYOUT,
    })
}

/// A daemon's information about itself.
pub(super) fn read_info(
    access: &Access,
    place: &FoundPlace,
    instance: &Instance,
    patience: Duration,
) -> Result<Info, WatchError> {
    let service = INFO.watch::<Info>(access, instance)?;
    let infos = subscribe(&service, instance)?;
    first(&service, (place, instance), patience, || newest(&infos))
}

fn read_columns(
    texts: &In<[u8]>,
    service: &Service<[u8]>,
    place: &FoundPlace,
    instance: &Instance,
) -> Result<RecordDescription, WatchError> {
    let text = first(service, (place, instance), PATIENCE, || {
        let found = texts.receive().map_err(failed)?;
        Ok(found.map(|sample| String::from_utf8_lossy(&sample).into_owned()))
    })?;
    RecordDescription::from_json(&text).map_err(|_| WatchError::Damaged(instance.clone()))
}

/// Waits for what a daemon publishes in its beginning.
fn first<T: Debug + IceoryxSend + ?Sized, R>(
    service: &Service<T>,
    (place, instance): (&FoundPlace, &Instance),
    patience: Duration,
    look: impl Fn() -> Result<Option<R>, WatchError>,
) -> Result<R, WatchError> {
    let deadline = Instant::now() + patience;
    loop {
        if let Some(found) = look()? {
            return Ok(found);
        }
        // Another watcher may have the service open after the daemon has ended;
        // and another process may publish elsewhere.
        let is_there = place.now() == Presence::Here(place.clone());
        if !is_there || service.dynamic_config().number_of_publishers() == 0 {
            return Err(WatchError::NotRunning(instance.clone()));
        }
        if Instant::now() > deadline {
            return Err(WatchError::NoAnswer(instance.clone(), patience.as_secs()));
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

pub(super) fn subscribe<T: Debug + IceoryxSend + ?Sized>(
    service: &Service<T>,
    instance: &Instance,
) -> Result<In<T>, WatchError> {
    service
        .subscriber_builder()
        .create()
        .map_err(|error| match error {
            SubscriberCreateError::ExceedsMaxSupportedSubscribers => {
                WatchError::TooMany(instance.clone())
            }
            error => WatchError::NoSharedMemory(services::explained(&error)),
        })
}

fn next<T: Debug + ZeroCopySend + Copy>(from: &In<T>) -> Result<Option<T>, WatchError> {
    let found = from.receive().map_err(failed)?;
    Ok(found.map(|sample| *sample))
}

pub(super) fn newest<T: Debug + ZeroCopySend + Copy>(
    from: &In<T>,
) -> Result<Option<T>, WatchError> {
    let mut newest = None;
    while let Some(found) = next(from)? {
        newest = Some(found);
    }
    Ok(newest)
}

fn failed(error: ReceiveError) -> WatchError {
    WatchError::NoSharedMemory(services::explained(&error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Publisher;
    use crate::offered::is_offered;

    /// As of a daemon that is stopped: what it publishes does not arrive.
    #[test]
    fn a_daemon_that_publishes_nothing_is_running_and_does_not_answer() {
        let name = format!("test-{}-hangs", std::process::id());
        let instance: Instance = name.parse().unwrap();
        let publisher = Publisher::start(&instance, 2_048).unwrap();
        let Presence::Here(place) = look(&instance) else {
            panic!("not here");
        };
        let access = services::access(&place.root).unwrap();
        let patience = Duration::from_millis(100);
        let find = || read_info(&access, &place, &instance, patience).unwrap_err();
        let message = find().to_string();
        assert!(
            message.contains(&format!("fccd '{name}' runs, but did not answer within")),
            "{message}"
        );
        let mut looks = 0..3;
        assert!(!is_offered(&instance, || looks.next().is_some()));
        drop(publisher);
        assert_eq!(find(), WatchError::NotRunning(instance.clone()));
    }

    /// On a busy machine all that the publisher does for a new watcher may come
    /// between a look and the decision that it has had its time.
    #[test]
    fn what_is_published_between_the_last_two_looks_is_found() {
        let name = format!("test-{}-busy", std::process::id());
        let instance: Instance = name.parse().unwrap();
        let mut publisher = Publisher::start(&instance, 2_048).unwrap();
        let Presence::Here(place) = look(&instance) else {
            panic!("not here");
        };
        let access = services::access(&place.root).unwrap();
        let patience = Duration::from_secs(10);
        let is_found = is_offered(&instance, || {
            publisher.describe(Info::default());
            // A watcher that came later has got it.
            read_info(&access, &place, &instance, patience).unwrap();
            false
        });
        assert!(is_found);
    }
}
