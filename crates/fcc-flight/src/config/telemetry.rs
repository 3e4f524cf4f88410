//! `[telemetry]`: live telemetry.

use fcc_telemetry::Instance;
use serde::{Deserialize, Serialize};

/// `[telemetry]`.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct TelemetrySection {
    /// Whether the flight is published in shared memory.
    pub enabled: bool,
    /// The instance name of this daemon.
    #[serde(with = "instance_name")]
    pub instance: Instance,
    /// Whether programs of the same user may give commands.
    pub commands: bool,
}

impl Default for TelemetrySection {
    fn default() -> Self {
        Self {
            enabled: true,
            instance: Instance::default(),
            commands: true,
        }
    }
}

/// An instance by its name.
mod instance_name {
    use std::str::FromStr;

    use fcc_telemetry::Instance;
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(super) fn serialize<S: Serializer>(name: &Instance, out: S) -> Result<S::Ok, S::Error> {
        out.collect_str(name)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Instance, D::Error> {
        let name = String::deserialize(from)?;
        Instance::from_str(&name).map_err(D::Error::custom)
    }
}
