//! Why a command is invalid.

use super::OutsideLimits;
use super::outside_limits::quantity;
use crate::units::Shown;

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
    /// The name of its file is too long, in bytes.
    #[error("the name of the file has {0} bytes: give one of at most {1}, with its path")]
    LongFileName(usize, usize),
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
