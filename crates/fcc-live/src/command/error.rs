//! Why a command was not carried out.

use super::super::WatchError;
use super::OutsideLimits;
use fcc_telemetry::Instance;

/// Why a command cannot be flown.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub enum Unflyable {
    /// It changes nothing.
    #[error("no set point is given: give an airspeed, a heading or an altitude")]
    NoSetpoint,
    /// It asks for what no aircraft flies, or not this one; in SI units.
    #[error(transparent)]
    Outside(#[from] OutsideLimits),
}

impl Unflyable {
    /// In the units of the command line: knots, degrees, feet.
    pub fn in_knots_degrees_feet(&self) -> String {
        match self {
            Self::NoSetpoint => self.to_string(),
            Self::Outside(outside) => outside.in_knots_degrees_feet(),
        }
    }
}

/// Why a command was not carried out.
#[derive(thiserror::Error, Clone, PartialEq, Debug)]
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
    /// It cannot be flown; in SI units.
    #[error("refused: {0}")]
    Unflyable(#[from] Unflyable),
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
