//! Lines of GPIO: `[[sensor]]` of the kind `gpio-switch`, and the heartbeat of
//! servos.

use std::path::PathBuf;
use std::time::Duration;

use fcc_core::framework::FALLBACK_AFTER;
use fcc_linux::gpio::{GpioPin, Pull};
use serde::{Deserialize, Serialize};

const USUAL_CHIP: &str = "/dev/gpiochip0";

/// The engage switch on a line.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct GpioSwitchSection {
    /// The chip.
    pub chip: PathBuf,
    /// The line's number there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// Whether a low level is on.
    pub active_low: bool,
    /// The line's resistor.
    pub pull: Pull,
    /// The switch has changed after this long at its new position.
    pub debounce_ms: u64,
    /// It counts as silent after this long without being read.
    pub silent_after_ms: u64,
    /// After this long without a position, the next sensor's is used.
    pub fallback_after_ms: u64,
}

/// The line that changes while the loop has control.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct HeartbeatSection {
    /// The chip.
    #[serde(default = "usual_chip")]
    pub chip: PathBuf,
    /// The line's number there.
    pub line: u32,
    /// Whether it rests at a high level.
    #[serde(default)]
    pub active_low: bool,
}

fn usual_chip() -> PathBuf {
    USUAL_CHIP.into()
}

impl Default for GpioSwitchSection {
    /// A switch to ground: a wire that is broken is off.
    fn default() -> Self {
        Self {
            chip: usual_chip(),
            line: None,
            active_low: true,
            pull: Pull::Up,
            debounce_ms: 30,
            silent_after_ms: 500,
            fallback_after_ms: FALLBACK_AFTER.as_millis() as u64,
        }
    }
}

impl GpioSwitchSection {
    /// Its line.
    pub fn pin(&self) -> GpioPin {
        GpioPin {
            chip: self.chip.clone(),
            line: self.line.unwrap_or_default(),
            is_active_low: self.active_low,
        }
    }

    /// After how long a contact rests.
    pub const fn settles_in(&self) -> Duration {
        Duration::from_millis(self.debounce_ms)
    }
}

impl HeartbeatSection {
    /// Its line.
    pub fn pin(&self) -> GpioPin {
        GpioPin {
            chip: self.chip.clone(),
            line: self.line,
            is_active_low: self.active_low,
        }
    }
}

/// More than any chip has.
pub(super) const HIGHEST_LINE: f64 = 1_023.0;
