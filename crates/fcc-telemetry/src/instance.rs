//! The name of a daemon on its machine.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The name of a daemon on its machine: 1 to 32 letters, digits, `-`, `_` and
/// `.`, but not `.` or `..`: files have this name, and those are folders. Two
/// daemons on one machine need two names.
///
/// ```
/// use fcc_telemetry::Instance;
///
/// let instance: Instance = "left-wing".parse()?;
/// assert_eq!(instance.to_string(), "left-wing");
/// assert!("left/wing".parse::<Instance>().is_err());
/// assert_eq!(Instance::default().to_string(), "fccd");
/// # Ok::<(), fcc_telemetry::InstanceError>(())
/// ```
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Instance(String);

/// The longest name: it must fit into the name of a service.
const MAX_LETTERS: usize = 32;

/// An invalid name.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[error(
    "'{0}' is not a valid instance name: choose 1 to {MAX_LETTERS} letters, digits, '-', '_' or \
     '.', but not '.' or '..'"
)]
pub struct InstanceError(String);

impl FromStr for Instance {
    type Err = InstanceError;

    fn from_str(name: &str) -> Result<Self, InstanceError> {
        let good = (1..=MAX_LETTERS).contains(&name.len())
            && name
                .bytes()
                .all(|letter| letter.is_ascii_alphanumeric() || b"-_.".contains(&letter))
            && ![".", ".."].contains(&name);
        if good {
            Ok(Self(name.to_owned()))
        } else {
            Err(InstanceError(name.to_owned()))
        }
    }
}

impl TryFrom<String> for Instance {
    type Error = InstanceError;

    fn try_from(name: String) -> Result<Self, InstanceError> {
        name.parse()
    }
}

impl From<Instance> for String {
    fn from(instance: Instance) -> Self {
        instance.0
    }
}

impl Default for Instance {
    fn default() -> Self {
        Self("fccd".to_owned())
    }
}

impl fmt::Display for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The socket of commands has this name.
    #[test]
    fn a_name_is_not_that_of_a_folder() {
        for name in [".", ".."] {
            assert!(name.parse::<Instance>().is_err(), "{name}");
        }
        assert!("...".parse::<Instance>().is_ok());
    }
}
