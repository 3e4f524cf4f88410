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
    #[serde(with = "super::as_text")]
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
