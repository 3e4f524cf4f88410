//! The reading side, for any plant.

use std::fmt::Debug;
use std::time::{Duration, Instant};

use iceoryx2::port::ReceiveError;
use iceoryx2::port::subscriber::{Subscriber, SubscriberCreateError};
use iceoryx2::prelude::{IceoryxSend, PortFactory, ZeroCopySend};

use super::place::Place;
use super::services::{self, Access, COLUMNS, EVENT, INFO, Ipc, RECORD, STATUS, Service};
use super::space;
use super::{Event, Info, LAYOUT, Status, WatchError};
use fcc_telemetry::Instance;
use fcc_telemetry::schema::RecordDescription;

/// How long a daemon may take to publish its information: long enough for a
/// busy machine. A daemon that has ended is noticed at once.
const PATIENCE: Duration = Duration::from_secs(5);
const LOOK_EVERY: Duration = Duration::from_millis(5);

type In<T> = Subscriber<Ipc, T, ()>;

/// Watches a loop of any plant on this machine, from this or another process:
/// each record is a row of words, whose columns the loop describes.
#[derive(Debug)]
pub struct RowWatcher {
    instance: Instance,
    info: Info,
    columns: RecordDescription,
    records: In<[u64]>,
    events: In<Event>,
    statuses: In<Status>,
    service: Service<[u64]>,
    // Dropped last: it cleans up after the others.
    access: Access,
}

impl RowWatcher {
    /// Starts to watch. The newest record, the newest status and up to 64 past
    /// events are available at once.
    ///
    /// # Errors
    /// When no daemon of this name runs here, it publishes in another layout,
    /// or the maximum number of programs is watching.
    pub fn open(instance: &Instance) -> Result<Self, WatchError> {
        if let Some(words) = space::too_little(space::WATCHER_BYTES) {
            return Err(WatchError::NoSharedMemory(words));
        }
        let access = services::access().map_err(WatchError::NoSharedMemory)?;
        let info = read_info(&access, instance)?;
        check_layout(&info, instance)?;
        let service = RECORD.watch_slices(&access, instance)?;
        Ok(Self {
            info,
            columns: read_columns(&access, instance)?,
            records: subscribe(&service, instance)?,
            events: subscribe(&EVENT.watch(&access, instance)?, instance)?,
            statuses: subscribe(&STATUS.watch(&access, instance)?, instance)?,
            service,
            access,
            instance: instance.clone(),
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
        let mut newest = None;
        while let Some(sample) = self.records.receive().map_err(failed)? {
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
        let found = self.records.receive().map_err(failed)?;
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
        next(&self.events)
    }

    /// The newest status not returned yet.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn latest_status(&mut self) -> Result<Option<Status>, WatchError> {
        newest(&self.statuses)
    }

    /// Whether the daemon still publishes. It checks processes: call it only
    /// when no data has come for a while.
    pub fn is_alive(&self) -> bool {
        // A killed one stays in the list until it is cleaned up.
        self.access.try_cleanup_dead_nodes();
        self.service.dynamic_config().number_of_publishers() > 0
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
pub(super) fn read_info(access: &Access, instance: &Instance) -> Result<Info, WatchError> {
    find_info(access, instance, PATIENCE).map_err(|error| match error {
        WatchError::NotRunning(instance) => {
            match Place::of_this_user().other_users().into_iter().next() {
                Some(user) => WatchError::PerhapsAnothers { instance, user },
                None => WatchError::NotRunning(instance),
            }
        }
        error => error,
    })
}

fn find_info(access: &Access, instance: &Instance, patience: Duration) -> Result<Info, WatchError> {
    let service = INFO.watch::<Info>(access, instance)?;
    let infos = subscribe(&service, instance)?;
    first(&service, instance, patience, || newest(&infos))
}

fn read_columns(access: &Access, instance: &Instance) -> Result<RecordDescription, WatchError> {
    let service = COLUMNS.watch_slices::<u8>(access, instance)?;
    let texts = subscribe(&service, instance)?;
    let text = first(&service, instance, PATIENCE, || {
        let found = texts.receive().map_err(failed)?;
        Ok(found.map(|sample| String::from_utf8_lossy(&sample).into_owned()))
    })?;
    RecordDescription::from_json(&text).map_err(|_| WatchError::Damaged(instance.clone()))
}

/// Waits for what a daemon publishes in its beginning.
fn first<T: Debug + IceoryxSend + ?Sized, R>(
    service: &Service<T>,
    instance: &Instance,
    patience: Duration,
    look: impl Fn() -> Result<Option<R>, WatchError>,
) -> Result<R, WatchError> {
    let deadline = Instant::now() + patience;
    loop {
        if let Some(found) = look()? {
            return Ok(found);
        }
        // Another watcher may have the service open after the daemon has ended.
        if service.dynamic_config().number_of_publishers() == 0 {
            return Err(WatchError::NotRunning(instance.clone()));
        }
        if Instant::now() > deadline {
            return Err(WatchError::NoAnswer(instance.clone(), patience.as_secs()));
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

fn subscribe<T: Debug + IceoryxSend + ?Sized>(
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

fn newest<T: Debug + ZeroCopySend + Copy>(from: &In<T>) -> Result<Option<T>, WatchError> {
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

    /// As of a daemon that is stopped: what it publishes does not arrive.
    #[test]
    fn a_daemon_that_publishes_nothing_is_running_and_does_not_answer() {
        let name = format!("test-{}-hangs", std::process::id());
        let instance: Instance = name.parse().unwrap();
        let access = services::access().unwrap();
        let find = || find_info(&access, &instance, Duration::from_millis(100)).unwrap_err();
        let publisher = Publisher::start(&instance, 2_048).unwrap();
        let message = find().to_string();
        assert!(
            message.contains(&format!("fccd '{name}' runs, but did not answer within")),
            "{message}"
        );
        drop(publisher);
        assert_eq!(find(), WatchError::NotRunning(instance.clone()));
    }
}
