//! `[restart]`: what to do about an interrupted flight.

use std::path::PathBuf;
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// `[restart]`.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct RestartSection {
    /// What a daemon does that is restarted in flight.
    pub mode: RestartMode,
    /// Where the flight's state is stored. Default: a file named after the
    /// instance, in systemd's state directory or next to the recordings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state_file: Option<PathBuf>,
    /// A flight that was interrupted longer ago is not recovered.
    pub max_age_s: f64,
    /// Controls that a killed flight and its release helper left held are
    /// released at the next start.
    pub release_left_held: bool,
}

/// What a daemon does that is restarted in flight.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RestartMode {
    /// Stay in standby, and report that a flight was interrupted.
    #[default]
    Cold,
    /// Continue it.
    Warm,
}

impl RestartMode {
    /// How long navigation needs to settle before the autopilot engages.
    /// In-flight recovery does not wait a full second: after 0.4 s the climb
    /// rate, the slowest to settle, is half settled, and fully within another
    /// second.
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
            release_left_held: true,
        }
    }
}
