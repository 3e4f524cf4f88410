//! `loop.early_wake.enabled`: `"auto"`, true or false.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::cpu::invalid;

const AUTO: &str = "auto";
const EXPECTED: &str = "\"auto\", true or false";

/// Whether the timer wakes early.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum EarlyWakeChoice {
    /// If the kernel grants the loop's thread a real-time priority.
    #[default]
    Auto,
    /// Always.
    On,
    /// Never.
    Off,
}

impl Serialize for EarlyWakeChoice {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => out.serialize_str(AUTO),
            Self::On => out.serialize_bool(true),
            Self::Off => out.serialize_bool(false),
        }
    }
}

impl<'de> Deserialize<'de> for EarlyWakeChoice {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let value = toml::Value::deserialize(from)?;
        match (value.as_str(), value.as_bool()) {
            (Some(AUTO), _) => Ok(Self::Auto),
            (_, Some(true)) => Ok(Self::On),
            (_, Some(false)) => Ok(Self::Off),
            _ => Err(invalid(&value, EXPECTED)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::EarlyWakeChoice;
    use crate::config::Config;

    fn parsed(value: &str) -> Result<Config, String> {
        let text = format!("[built-in]\n[loop.early_wake]\nenabled = {value}\n");
        Config::parse(&text, "flight.toml").map_err(|error| error.to_string())
    }

    #[test]
    fn auto_is_the_default_and_needs_a_real_time_priority() {
        let default = Config::parse("[built-in]\n", "flight.toml").unwrap();
        assert_eq!(default.tick.early_wake.enabled, EarlyWakeChoice::Auto);
        for (value, choice, needs_priority) in [
            ("\"auto\"", EarlyWakeChoice::Auto, true),
            ("true", EarlyWakeChoice::On, false),
            ("false", EarlyWakeChoice::Off, false),
        ] {
            let config = parsed(value).unwrap();
            assert_eq!(config.tick.early_wake.enabled, choice);
            let loop_config = config.loop_config();
            assert_eq!(loop_config.early_wake_needs_priority, needs_priority);
        }
    }

    #[test]
    fn anything_else_is_refused_with_the_choices() {
        for value in ["1", "\"on\"", "[]"] {
            let message = parsed(value).unwrap_err();
            assert!(message.contains("flight.toml:3"), "{message}");
            assert!(message.contains("loop.early_wake.enabled"), "{message}");
            assert!(message.contains("\"auto\", true or false"), "{message}");
        }
    }
}
