//! Why a command was not carried out.

use super::super::WatchError;
use super::OutsideLimits;
use super::outside_limits::quantity;
use fcc_telemetry::Instance;
use fcc_telemetry::units::Shown;

/// Why a command is invalid.
#[derive(thiserror::Error, Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum InvalidCommand {
    /// It changes nothing; the names of the set points.
    #[error("no set point is given: choose of {}", .0.join(", "))]
    NoSetpoint(Vec<&'static str>),
    /// The controller has no such set point; the names of those that it has.
    #[error("there is no set point '{}': choose of {}", .0, .1.join(", "))]
    UnknownSetpoint(String, Vec<&'static str>),
    /// It has several values of which only one is permitted.
    #[error("{0}")]
    Alternatives(&'static str),
    /// The plant does not have this set point, for this reason.
    #[error("{0}")]
    NotPermitted(&'static str),
    /// It changes more than a command can.
    #[error("more than {0} set points in one command: give several commands")]
    TooManySetpoints(usize),
    /// A set point is out of its limits, in the unit at the end of its name.
    #[error(transparent)]
    Outside(#[from] OutsideLimits),
}

impl InvalidCommand {
    /// As text, in those of these units that fit, with quantities instead of
    /// names.
    pub fn text_in(&self, units: &[Shown]) -> String {
        match self {
            Self::Outside(outside) => outside.text_in(units),
            Self::NoSetpoint(names) => {
                let names = names.iter().map(|name| quantity(name));
                let names: Vec<_> = names.collect();
                format!("no set point is given: choose of {}", names.join(", "))
            }
            other => other.to_string(),
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
    /// The daemon runs and accepts no commands.
    #[error(
        "fccd '{instance}', version {software}, accepts no commands of version {own}: it has commands = \
         false under [telemetry], or is another version"
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
