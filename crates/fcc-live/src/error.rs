//! Why nothing can be published or watched.

use super::MAX_WATCHERS;
use fcc_telemetry::Instance;

/// Why nothing can be published. The flight goes on without.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum PublishError {
    /// Another daemon has this name.
    #[error(
        "another fccd publishes as '{0}': give this one another name, with --instance NAME or \
         instance under [telemetry]"
    )]
    NameTaken(Instance),
    /// Watchers of a daemon of another version still hold its services.
    #[error(
        "programs that watched another version of '{0}' still hold its services: end them, or \
         give this daemon another name with --instance NAME"
    )]
    HeldByOthers(Instance),
    /// The system's shared memory is not to be had.
    #[error("no shared memory: {0}")]
    NoSharedMemory(String),
}

/// Why nothing can be watched.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum WatchError {
    /// No daemon of this name publishes on this machine.
    #[error(
        "no fccd named '{0}' runs here: start one, for example with `fccd fly --instance {0}`, or \
         give another's name with --instance"
    )]
    NotRunning(Instance),
    /// This user has no daemon of this name, but others have daemons, or had.
    #[error(
        "no fccd named '{instance}' runs here for this user. A daemon of another user can be \
         watched by that user alone: sudo -u {user} fccd top --instance {instance}"
    )]
    PerhapsAnothers {
        /// The daemon.
        instance: Instance,
        /// The other user; the first of several.
        user: String,
    },
    /// The daemon is of a version with another layout.
    #[error(
        "fccd '{instance}' is version {software} and publishes in layout {layout}; this program \
         reads layout {own}: use the fccd that belongs to the daemon"
    )]
    OtherLayout {
        /// The daemon.
        instance: Instance,
        /// Its version.
        software: String,
        /// Its layout.
        layout: u32,
        /// This program's.
        own: u32,
    },
    /// As many programs watch as may.
    #[error(
        "{MAX_WATCHERS} programs watch fccd '{0}', and there is room for no more: end one of them"
    )]
    TooMany(Instance),
    /// The daemon belongs to another user.
    #[error("fccd '{0}' belongs to another user: only the daemon's own user may watch it")]
    NotPermitted(Instance),
    /// The daemon that was watched is gone.
    #[error("fccd '{0}' has ended: it publishes no more")]
    Ended(Instance),
    /// What lies in shared memory is no record.
    #[error(
        "fccd '{0}' publishes what is no record: another program writes to its services, or this \
         one was built from other sources"
    )]
    Damaged(Instance),
    /// The system's shared memory is not to be had.
    #[error("no shared memory: {0}")]
    NoSharedMemory(String),
}
