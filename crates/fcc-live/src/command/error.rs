//! Why a command was not carried out.

use super::super::WatchError;
use super::InvalidCommand;
use fcc_telemetry::Instance;

/// Why a command was not carried out.
#[derive(thiserror::Error, Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum CommandError {
    /// The daemon cannot be reached.
    #[error(transparent)]
    Unreachable(#[from] WatchError),
    /// The daemon runs and accepts no commands.
    #[error(
        "fccd '{instance}', version {software}, accepts no commands of version {own}: it is ending, has \
         commands = false under [telemetry], or is another version"
    )]
    NotAccepted {
        /// The daemon.
        instance: Instance,
        /// Its version.
        software: String,
        /// The version of this program's commands.
        own: u32,
    },
    /// The maximum number of programs is connected.
    #[error("too many programs give commands to fccd '{0}' at once: end one of them")]
    TooMany(Instance),
    /// The command is invalid.
    #[error("refused: {0}")]
    InvalidCommand(#[from] InvalidCommand),
    /// The daemon refused it.
    #[error("refused: {0}")]
    Refused(String),
    /// The daemon did not answer: it is not known whether the command was
    /// carried out.
    #[error(
        "fccd '{0}' did not answer within {1} s, so it is not known whether the command was carried \
         out: check it with `fccd top --instance {0}`"
    )]
    NoAnswer(Instance, u64),
}
