//! `realtime.cpu`: `"auto"`, or the number of a CPU.

use std::str::FromStr;

use fcc_timer::CpuRequest;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The number of CPUs in the kernel's CPU sets as used here.
const LAST_CPU: usize = 1_023;
const AUTO: &str = "auto";
const EXPECTED: &str = "\"auto\" or the number of a CPU, 0 to 1023";

/// The CPU that the loop's thread is bound to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CpuChoice {
    /// The best CPU, if one is better than the others.
    Auto,
    /// This one, counted from 0.
    Number(usize),
}

impl From<CpuChoice> for CpuRequest {
    fn from(choice: CpuChoice) -> Self {
        match choice {
            CpuChoice::Auto => Self::Auto,
            CpuChoice::Number(cpu) => Self::Number(cpu),
        }
    }
}

impl FromStr for CpuChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            (AUTO, _) => Ok(Self::Auto),
            (_, Ok(cpu)) if cpu <= LAST_CPU => Ok(Self::Number(cpu)),
            _ => Err(format!("give {EXPECTED}")),
        }
    }
}

impl Serialize for CpuChoice {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => out.serialize_str(AUTO),
            Self::Number(cpu) => out.serialize_u64(*cpu as u64),
        }
    }
}

impl<'de> Deserialize<'de> for CpuChoice {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let value = toml::Value::deserialize(from)?;
        let number = value.as_integer().map(usize::try_from);
        match (value.as_str(), number) {
            (Some(AUTO), _) => Ok(Self::Auto),
            (_, Some(Ok(cpu))) if cpu <= LAST_CPU => Ok(Self::Number(cpu)),
            _ => Err(invalid(&value, EXPECTED)),
        }
    }
}

/// An error in the words of the reader's own.
pub(super) fn invalid<E: Error>(value: &toml::Value, expected: &str) -> E {
    E::custom(format_args!("invalid value: {value}, expected {expected}"))
}

#[cfg(test)]
mod tests {
    use crate::config::Config;

    fn message(value: &str) -> String {
        let text = format!("[built-in]\n[realtime]\ncpu = {value}\n");
        let error = Config::parse(&text, "flight.toml").unwrap_err();
        error.to_string()
    }

    #[test]
    fn an_invalid_cpu_is_refused_with_the_choices() {
        for value in ["-1", "1024", "\"isolated\"", "true", "1.5"] {
            let text = message(value);
            assert!(text.contains("flight.toml:3"), "{text}");
            assert!(text.contains("realtime.cpu"), "{text}");
            assert!(text.contains("choose \"auto\" or the number"), "{text}");
        }
    }
}
