//! The reading end.

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

/// How long a daemon may take to say who it is: long after one on a busy
/// machine has. One that is gone is noticed at once.
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
    // Last: it cleans up after the others.
    access: Access,
}

impl<C: Telemetry> WatcherOf<C> {
    /// Begins to watch. The newest record, the newest status and up to 64
    /// events of the past are there at once.
    ///
    /// # Errors
    /// When no daemon of this name runs here, when it is of a version with
    /// another layout, and when there is no room for another watcher.
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

    /// Who publishes.
    pub const fn info(&self) -> &Info {
        &self.info
    }

    /// The newest record that was not given yet; those before it are passed
    /// over.
    ///
    /// # Errors
    /// When what is there is no record, or shared memory fails.
    pub fn latest(&mut self) -> Result<Option<RecordOf<C>>, WatchError> {
        let mut newest = None;
        while let Some(found) = next(&self.records)? {
            newest = Some(found);
        }
        newest.map(|found| self.record(&found)).transpose()
    }

    /// The next record; none if there is none yet. Whoever looks less often
    /// than each second at 1 kHz misses records: their ticks' numbers tell.
    ///
    /// # Errors
    /// When what is there is no record, or shared memory fails.
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

    /// The newest status that was not given yet.
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

    /// Whether the daemon still publishes. Worth asking when nothing has come
    /// for a while: it looks at the processes.
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
    // One that was killed is still in the list until somebody cleans up.
    access.try_cleanup_dead_nodes();
    service.dynamic_config().number_of_publishers() > 0
}

/// Whether this program understands what the daemon publishes.
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

/// What a daemon says of itself.
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
        // Another watcher may hold the service open when the daemon is gone.
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
