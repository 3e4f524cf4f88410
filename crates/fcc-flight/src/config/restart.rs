//! `[restart]`: what becomes of a flight that was cut off.

use std::path::PathBuf;
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// `[restart]`.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct RestartSection {
    /// What a daemon does that was started again in flight.
    pub mode: RestartMode,
    /// Where it is kept what is flown. Left out, a file named after the
    /// instance, in systemd's state directory or beside the recordings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state_file: Option<PathBuf>,
    /// A flight that was cut off longer ago is not taken up.
    pub max_age_s: f64,
}

/// What a daemon does that was started again in flight.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RestartMode {
    /// Stand by, and say that a flight was cut off.
    #[default]
    Cold,
    /// Take it up again.
    Warm,
}

impl RestartMode {
    /// For how long navigation has to have watched before the autopilot takes
    /// over. Who takes up a flight has no second to spare: after 0.4 s the
    /// climb rate, the slowest to settle, is known to half, and the rest comes
    /// within another second.
    pub(super) const fn settling(self) -> Duration {
        match self {
            Self::Cold => Duration::from_secs(1),
            Self::Warm => Duration::from_millis(400),
        }
    }
}

impl Default for RestartSection {
    fn default() -> Self {
        Self {
            mode: RestartMode::Cold,
            state_file: None,
            max_age_s: 10.0,
        }
    }
}
