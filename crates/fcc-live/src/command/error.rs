//! Why a command was not carried out.

use super::super::WatchError;
use super::OutsideLimits;
use fcc_telemetry::Instance;

/// Why a command is invalid.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub enum InvalidCommand {
    /// It changes nothing.
    #[error(
        "no set point is given: give an airspeed, a heading, an altitude or an altimeter setting"
    )]
    NoSetpoint,
    /// It has several altitudes.
    #[error("several altitudes are given: give an altitude, a pressure altitude or a height")]
    SeveralAltitudes,
    /// It has a height, and what heights refer to is not configured.
    #[error(
        "a height needs the elevation of its field: set altimeter.field_elevation_ft in the \
         configuration, or give an altitude"
    )]
    NoFieldElevation,
    /// A set point is out of range, for any aircraft or for this one; in SI
    /// units.
    #[error(transparent)]
    Outside(#[from] OutsideLimits),
}

impl InvalidCommand {
    /// In the units of the command line: knots, degrees, feet.
    pub fn in_knots_degrees_feet(&self) -> String {
        match self {
            Self::NoSetpoint | Self::SeveralAltitudes | Self::NoFieldElevation => self.to_string(),
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
    /// The command is invalid; in SI units.
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
