//! The reading side.

use std::time::{Duration, Instant};

use fcc_core::framework::RecordOf;
use iceoryx2::port::subscriber::{Subscriber, SubscriberCreateError};
use iceoryx2::prelude::{PortFactory, ZeroCopySend};

use super::place::Place;
use super::record::Published;
use super::services::{self, Access, EVENT, INFO, Ipc, RECORD, STATUS, Service};
use super::space;
use super::{Event, Info, LAYOUT, Status, WatchError};
use fcc_telemetry::{Instance, RecordWords as _, Telemetry};

/// How long a daemon may take to publish its information: long enough for a
/// busy machine. A daemon that has ended is noticed at once.
const PATIENCE: Duration = Duration::from_secs(5);
const LOOK_EVERY: Duration = Duration::from_millis(5);

type In<T> = Subscriber<Ipc, T, ()>;

/// Watches a flight on this machine.
#[cfg(feature = "flight")]
pub type Watcher = WatcherOf<fcc_core::flight::Autopilot>;

/// Watches a loop on this machine, from this or another process.
///
/// ```no_run
/// use fcc_telemetry::Instance;
/// use fcc_live::Watcher;
///
/// let mut watcher = Watcher::open(&Instance::default())?;
/// println!("{} Hz by {}", watcher.info().rate_hz, watcher.info().timer);
/// while watcher.is_alive() {
///     if let Some(record) = watcher.latest()? {
///         println!("{} m", record.measurements.altitude_m.value);
///     }
///     std::thread::sleep(std::time::Duration::from_millis(100));
/// }
/// # Ok::<(), fcc_live::WatchError>(())
/// ```
#[derive(Debug)]
pub struct WatcherOf<C: Telemetry> {
    instance: Instance,
    info: Info,
    records: In<Published<C>>,
    events: In<Event>,
    statuses: In<Status>,
    service: Service<Published<C>>,
    // Dropped last: it cleans up after the others.
    access: Access,
}

impl<C: Telemetry> WatcherOf<C> {
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
        let service = RECORD.watch::<Published<C>>(&access, instance)?;
        Ok(Self {
            info,
            records: subscribe(&service, instance)?,
            events: subscribe(&EVENT.watch(&access, instance)?, instance)?,
            statuses: subscribe(&STATUS.watch(&access, instance)?, instance)?,
            service,
            access,
            instance: instance.clone(),
        })
    }

    /// The daemon.
    pub const fn info(&self) -> &Info {
        &self.info
    }

    /// The newest record not returned yet; earlier ones are skipped.
    ///
    /// # Errors
    /// When it is not a valid record, or shared memory fails.
    pub fn latest(&mut self) -> Result<Option<RecordOf<C>>, WatchError> {
        let mut newest = None;
        while let Some(found) = next(&self.records)? {
            newest = Some(found);
        }
        newest.map(|found| self.record(&found)).transpose()
    }

    /// The next record; none if there is none yet. A watcher that polls less
    /// often than each second at 1 kHz misses records: the ticks' numbers show
    /// it.
    ///
    /// # Errors
    /// When it is not a valid record, or shared memory fails.
    pub fn next_record(&mut self) -> Result<Option<RecordOf<C>>, WatchError> {
        next(&self.records)?
            .map(|found| self.record(&found))
            .transpose()
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
        let mut newest = None;
        while let Some(status) = next(&self.statuses)? {
            newest = Some(status);
        }
        Ok(newest)
    }

    /// Whether the daemon still publishes. It checks processes: call it only
    /// when no data has come for a while.
    pub fn is_alive(&self) -> bool {
        publishes(&self.access, &self.service)
    }

    fn record(&self, found: &Published<C>) -> Result<RecordOf<C>, WatchError> {
        found
            .0
            .record()
            .map_err(|_| WatchError::Damaged(self.instance.clone()))
    }
}

fn publishes<T: std::fmt::Debug + ZeroCopySend>(access: &Access, service: &Service<T>) -> bool {
    // A killed one stays in the list until it is cleaned up.
    access.try_cleanup_dead_nodes();
    service.dynamic_config().number_of_publishers() > 0
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
    find_info(access, instance).map_err(|error| match error {
        WatchError::NotRunning(instance) => {
            match Place::of_this_user().other_users().into_iter().next() {
                Some(user) => WatchError::PerhapsAnothers { instance, user },
                None => WatchError::NotRunning(instance),
            }
        }
        error => error,
    })
}

fn find_info(access: &Access, instance: &Instance) -> Result<Info, WatchError> {
    let service = INFO.watch::<Info>(access, instance)?;
    let infos = subscribe(&service, instance)?;
    let deadline = Instant::now() + PATIENCE;
    loop {
        let mut newest = None;
        while let Some(info) = next(&infos)? {
            newest = Some(info);
        }
        if let Some(info) = newest {
            return Ok(info);
        }
        // Another watcher may have the service open after the daemon has ended.
        if Instant::now() > deadline || service.dynamic_config().number_of_publishers() == 0 {
            return Err(WatchError::NotRunning(instance.clone()));
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

fn subscribe<T: std::fmt::Debug + ZeroCopySend + 'static>(
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

fn next<T: std::fmt::Debug + ZeroCopySend + Copy + 'static>(
    from: &In<T>,
) -> Result<Option<T>, WatchError> {
    match from.receive() {
        Ok(sample) => Ok(sample.map(|sample| *sample)),
        Err(error) => Err(WatchError::NoSharedMemory(services::explained(&error))),
    }
}
