//! The services, for both sides.

use std::fmt::Debug;

use iceoryx2::node::{Node, NodeBuilder};
use iceoryx2::port::publisher::{Publisher, PublisherCreateError};
use iceoryx2::prelude::{BackpressureStrategy, IceoryxSend, SignalHandlingMode, ZeroCopySend};
use iceoryx2::service::builder::publish_subscribe::{
    Builder, PublishSubscribeOpenError, PublishSubscribeOpenOrCreateError,
};
use iceoryx2::service::port_factory::publish_subscribe::PortFactory;
use iceoryx2::service::port_factory::publisher::PortFactoryPublisher;
use iceoryx2::service::service_name::ServiceName;
use nix::sys::resource::{Resource, getrlimit};

use super::place;
use super::private_service::PrivateService;
use super::{LAYOUT, PublishError, WatchError};
use fcc_telemetry::{Instance, RunFolder};

/// The number of programs that may watch one daemon at the same time. One more
/// is refused, without effect on the others and the daemon. The place of a
/// killed program is free again within a second.
pub const MAX_WATCHERS: usize = 64;

/// Records queued for a watcher: one second at 1 kHz. A slower watcher gets the
/// newest; it finds the gap from the ticks' numbers.
pub const RECORD_BUFFER: usize = 1_024;

/// Past events that a new watcher receives, and the length of its queue.
pub const EVENT_HISTORY: usize = 64;

/// Processes that may have a service open: the watchers, the daemon, and some
/// that were killed and not cleaned up yet, or only check whether there is
/// room.
const MAX_NODES: usize = MAX_WATCHERS + 32;

/// Samples that a watcher may hold at once.
const BORROWED: usize = 2;

/// Shared memory between processes of one user.
pub(super) type Ipc = PrivateService;
/// A service of plain data, or of slices of it.
pub(super) type Service<T> = PortFactory<Ipc, T, ()>;
/// The writing side of a service.
pub(super) type Out<T> = Publisher<Ipc, T, ()>;
/// A service and its writing side.
type Published<T> = (Service<T>, Out<T>);
/// A process' access to all services.
pub(super) type Access = Node<Ipc>;

/// One of the services of a daemon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Topic {
    name: &'static str,
    versioned: bool,
    buffer: usize,
    history: usize,
}

/// Information about the daemon.
pub(super) const INFO: Topic = Topic {
    name: "info",
    versioned: false,
    buffer: 2,
    history: 1,
};
/// The columns of its records, as JSON.
pub(super) const COLUMNS: Topic = Topic {
    name: "columns",
    versioned: true,
    buffer: 1,
    history: 1,
};
/// Each tick, as words.
pub(super) const RECORD: Topic = Topic {
    name: "record",
    versioned: true,
    buffer: RECORD_BUFFER,
    history: 1,
};
/// Events.
pub(super) const EVENT: Topic = Topic {
    name: "event",
    versioned: true,
    buffer: EVENT_HISTORY,
    history: EVENT_HISTORY,
};
/// The status of the run.
pub(super) const STATUS: Topic = Topic {
    name: "status",
    versioned: true,
    buffer: 2,
    history: 1,
};

impl Topic {
    fn service_name(self, instance: &Instance) -> Option<ServiceName> {
        let name = if self.versioned {
            format!("fcc/{instance}/{}/v{LAYOUT}", self.name)
        } else {
            format!("fcc/{instance}/{}", self.name)
        };
        // Every valid instance name is a valid part of a service name.
        ServiceName::new(&name).ok()
    }

    /// All samples that can be in use at once. Slow watchers share the newest
    /// ones, and each has those it has borrowed: far less than the product of
    /// watchers and buffer that is reserved by default. Columns are sent once.
    const fn samples(self) -> usize {
        if self.buffer == 1 {
            return self.buffer + self.history;
        }
        self.buffer + self.history + MAX_WATCHERS * BORROWED + 16
    }

    /// Opens the writing side, and creates the service if it does not exist.
    pub(super) fn publish<T: Debug + ZeroCopySend + 'static>(
        self,
        access: &Access,
        instance: &Instance,
    ) -> Result<Published<T>, PublishError> {
        let service = self.settings::<T>(access, instance)?.open_or_create();
        let service = service.map_err(|error| refused(error, instance))?;
        let publisher = self.port(&service).create();
        let publisher = publisher.map_err(|error| not_created(error, instance))?;
        Ok((service, publisher))
    }

    /// The same for messages of at most `most` elements.
    pub(super) fn publish_slices<T: Debug + ZeroCopySend + 'static>(
        self,
        access: &Access,
        instance: &Instance,
        most: usize,
    ) -> Result<Published<[T]>, PublishError> {
        let service = self.settings::<[T]>(access, instance)?.open_or_create();
        let service = service.map_err(|error| refused(error, instance))?;
        let port = self.port(&service).initial_max_slice_len(most);
        let publisher = port.create();
        let publisher = publisher.map_err(|error| not_created(error, instance))?;
        Ok((service, publisher))
    }

    fn settings<T: Debug + IceoryxSend + ?Sized>(
        self,
        access: &Access,
        instance: &Instance,
    ) -> Result<Builder<T, (), Ipc>, PublishError> {
        let name = self.service_name(instance).ok_or_else(|| {
            PublishError::NoSharedMemory(format!("'{instance}' is not a valid service name"))
        })?;
        let builder = access.service_builder(&name).publish_subscribe::<T>();
        Ok(builder
            .max_publishers(1)
            .max_subscribers(MAX_WATCHERS)
            .max_nodes(MAX_NODES)
            .subscriber_max_buffer_size(self.buffer)
            .subscriber_max_borrowed_samples(BORROWED)
            .history_size(self.history)
            // The oldest is overwritten: nothing waits for a watcher that
            // hangs.
            .enable_safe_overflow(true))
    }

    fn port<T: Debug + IceoryxSend + ?Sized>(
        self,
        service: &Service<T>,
    ) -> PortFactoryPublisher<'_, Ipc, T, ()> {
        service
            .publisher_builder()
            .max_loaned_samples(2)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .override_sample_preallocation(move |most| most.min(self.samples()))
    }

    /// Opens the reading side; never creates a service.
    pub(super) fn watch<T: Debug + ZeroCopySend + 'static>(
        self,
        access: &Access,
        instance: &Instance,
    ) -> Result<Service<T>, WatchError> {
        let service = self.reading::<T>(access, instance)?.open();
        service.map_err(|error| not_opened(error, instance))
    }

    /// The same for messages of several elements.
    pub(super) fn watch_slices<T: Debug + ZeroCopySend + 'static>(
        self,
        access: &Access,
        instance: &Instance,
    ) -> Result<Service<[T]>, WatchError> {
        let service = self.reading::<[T]>(access, instance)?.open();
        service.map_err(|error| not_opened(error, instance))
    }

    fn reading<T: Debug + IceoryxSend + ?Sized>(
        self,
        access: &Access,
        instance: &Instance,
    ) -> Result<Builder<T, (), Ipc>, WatchError> {
        let name = self.service_name(instance);
        let name = name.ok_or_else(|| WatchError::NotRunning(instance.clone()))?;
        Ok(access.service_builder(&name).publish_subscribe::<T>())
    }
}

fn not_created(error: PublisherCreateError, instance: &Instance) -> PublishError {
    match error {
        PublisherCreateError::ExceedsMaxSupportedPublishers => {
            PublishError::NameTaken(instance.clone())
        }
        error => PublishError::NoSharedMemory(explained(&error)),
    }
}

fn not_opened(error: PublishSubscribeOpenError, instance: &Instance) -> WatchError {
    use PublishSubscribeOpenError as Open;
    match error {
        Open::DoesNotExist | Open::IsMarkedForDestruction | Open::HangsInCreation => {
            WatchError::NotRunning(instance.clone())
        }
        Open::ExceedsMaxNumberOfNodes => WatchError::TooMany(instance.clone()),
        Open::InsufficientPermissions => WatchError::NotPermitted(instance.clone()),
        Open::IncompatibleTypes => WatchError::Damaged(instance.clone()),
        error => WatchError::NoSharedMemory(explained(&error)),
    }
}

fn refused(error: PublishSubscribeOpenOrCreateError, instance: &Instance) -> PublishError {
    use PublishSubscribeOpenError as Open;
    use PublishSubscribeOpenOrCreateError as Refused;
    match error {
        Refused::PublishSubscribeOpenError(
            Open::IncompatibleTypes
            | Open::IncompatibleOverflowBehavior
            | Open::IncompatibleMessagingPattern
            | Open::DoesNotSupportRequestedMinBufferSize
            | Open::DoesNotSupportRequestedMinHistorySize
            | Open::DoesNotSupportRequestedMinSubscriberBorrowedSamples
            | Open::DoesNotSupportRequestedAmountOfPublishers
            | Open::DoesNotSupportRequestedAmountOfSubscribers
            | Open::DoesNotSupportRequestedAmountOfNodes
            | Open::VersionMismatch,
        ) => PublishError::HeldByOthers(instance.clone()),
        error => PublishError::NoSharedMemory(explained(&error)),
    }
}

/// A failure of iceoryx2 as text, with the limits of this process that are so
/// low that they explain it.
pub(super) fn explained(error: &impl Debug) -> String {
    format!("iceoryx2: {error:?}{}", low_limits())
}

/// iceoryx2 does not say which limit it met.
fn low_limits() -> String {
    let limits = [
        (
            Resource::RLIMIT_NOFILE,
            64,
            "files may be open: give the service LimitNOFILE=1024 (a shell: ulimit -n 1024)",
        ),
        (
            Resource::RLIMIT_FSIZE,
            1 << 24,
            "bytes may be in a file: give the service LimitFSIZE=infinity (a shell: ulimit -f \
             unlimited)",
        ),
    ];
    let low = limits.into_iter().filter_map(|(limit, enough, what)| {
        let (limit, _) = getrlimit(limit).ok()?;
        (limit < enough).then(|| format!("; only {limit} {what}"))
    });
    low.collect::<Vec<_>>().concat()
}

/// This process' access to the services in a folder.
///
/// # Errors
/// Why there is no shared memory, as text.
pub(super) fn access(root: &RunFolder) -> Result<Access, String> {
    let access = NodeBuilder::new()
        .config(&place::config(root)?)
        // The daemon and its commands handle signals themselves.
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<Ipc>()
        .map_err(|error| explained(&error))?;
    // Whatever the global configuration of iceoryx2 says about cleaning up.
    access.try_cleanup_dead_nodes();
    Ok(access)
}
