//! Why a command was not carried out.

use super::super::WatchError;
use crate::Instance;

/// Why a command was not carried out.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum CommandError {
    /// The daemon cannot be reached.
    #[error(transparent)]
    Unreachable(#[from] WatchError),
    /// The daemon flies and takes no commands.
    #[error(
        "fccd '{instance}', version {software}, takes no commands of version {own}: it has commands = \
         false under [telemetry], or is another version"
    )]
    TakesNone {
        /// The daemon.
        instance: Instance,
        /// Its version.
        software: String,
        /// The version of this program's commands.
        own: u32,
    },
    /// As many programs give commands as may.
    #[error("too many programs give commands to fccd '{0}' at once: end one of them")]
    TooMany(Instance),
    /// The daemon refused it.
    #[error("refused: {0}")]
    Refused(String),
    /// The daemon did not answer: whether it was carried out is not known.
    #[error(
        "fccd '{0}' did not answer within {1} s, so it is not known whether the command was carried \
         out: look at it with `fccd top --instance {0}`"
    )]
    NoAnswer(Instance, u64),
}
