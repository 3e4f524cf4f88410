//! Why publishing or watching failed.

use serde::{Deserialize, Serialize};

use super::{MAX_WATCHERS, place};
use fcc_telemetry::Instance;

/// Why nothing can be published. The flight continues without.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[non_exhaustive]
pub enum PublishError {
    /// Another daemon has this name.
    #[error(
        "another fccd publishes as '{0}': give this one another name, with --instance NAME or \
         instance under [telemetry]"
    )]
    NameTaken(Instance),
    /// Programs that watched a daemon of another version still have its
    /// services open.
    #[error(
        "programs that watched another version of '{0}' still have its services open: end them, or \
         give this daemon another name with --instance NAME"
    )]
    HeldByOthers(Instance),
    /// The system's shared memory is not available.
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
         give another's name with --instance{running}", running = place::in_words(&place::running())
    )]
    NotRunning(Instance),
    /// The daemon runs, but what it publishes did not arrive within so many
    /// seconds: it is stopped, or hangs.
    #[error(
        "fccd '{0}' runs, but did not answer within {1} s: it is stopped (continue it with \
         `kill -CONT` and its process number), hangs, or the machine is overloaded"
    )]
    NoAnswer(Instance, u64),
    /// Another user has a daemon of this name.
    #[error(
        "no fccd named '{instance}' runs here for this user. One runs for {user}, and can be \
         watched by that user alone: sudo -u '{user}' fccd top --instance {instance}"
    )]
    Anothers {
        /// The daemon's name.
        instance: Instance,
        /// The other user; the first of several.
        user: String,
    },
    /// This user has no daemon of this name; other users have or had daemons,
    /// and only they see by which names.
    #[error(
        "no fccd named '{0}' runs here for this user: start one, for example with `fccd fly \
         --instance {0}`, or give another's name with --instance. A daemon of another user can be \
         watched by that user alone: sudo -u USER fccd top --instance {0}{running}",
        running = place::in_words(&place::running())
    )]
    PerhapsAnothers(Instance),
    /// The daemon publishes in another layout.
    #[error(
        "fccd '{instance}' is version {software} and publishes in layout {layout}; this program \
         reads layout {own}: use the fccd that belongs to the daemon"
    )]
    OtherLayout {
        /// The daemon's name.
        instance: Instance,
        /// Its version.
        software: String,
        /// Its layout.
        layout: u32,
        /// This program's.
        own: u32,
    },
    /// The loop is of another plant than the program's.
    #[error(
        "'{instance}' is a loop of another plant, {plant}: watch it with its own program, or in \
         Python with fcc.Watcher, which watches every plant's"
    )]
    AnotherPlant {
        /// The daemon's name.
        instance: Instance,
        /// Its plant.
        plant: String,
    },
    /// The maximum number of programs is watching.
    #[error("{MAX_WATCHERS} programs watch fccd '{0}', which is the maximum: end one of them")]
    TooMany(Instance),
    /// The daemon belongs to another user.
    #[error("fccd '{0}' belongs to another user: only the daemon's own user may watch it")]
    NotPermitted(Instance),
    /// The watcher is of the process that forked this one.
    #[error(
        "this was opened before fork(), and belongs to the process that opened it: open another \
         one in this process"
    )]
    Forked,
    /// The daemon has ended.
    #[error("fccd '{0}' has ended")]
    Ended(Instance),
    /// The data in shared memory is not a record.
    #[error(
        "fccd '{0}' publishes invalid records: another program writes to its services, or this \
         one was built from other sources"
    )]
    Damaged(Instance),
    /// The system's shared memory is not available.
    #[error("no shared memory: {0}")]
    NoSharedMemory(String),
}
