//! Why an order was not carried out.

use super::super::WatchError;
use crate::Instance;

/// Why an order was not carried out.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum OrderError {
    /// The daemon cannot be reached.
    #[error(transparent)]
    Unreachable(#[from] WatchError),
    /// The daemon flies and takes no orders.
    #[error(
        "fccd '{instance}', version {software}, takes no orders of version {own}: it has orders = \
         false under [telemetry], or is another version"
    )]
    TakesNone {
        /// The daemon.
        instance: Instance,
        /// Its version.
        software: String,
        /// The version of this program's orders.
        own: u32,
    },
    /// As many programs give orders as may.
    #[error("too many programs give orders to fccd '{0}' at once: end one of them")]
    TooMany(Instance),
    /// The daemon refused it.
    #[error("refused: {0}")]
    Refused(String),
    /// The daemon did not answer: whether it was carried out is not known.
    #[error(
        "fccd '{0}' did not answer within {1} s, so it is not known whether the order was carried \
         out: look at it with `fccd top --instance {0}`"
    )]
    NoAnswer(Instance, u64),
}
