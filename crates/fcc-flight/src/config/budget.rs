//! `[budget]`, `[overload]` and `[watchdog]`: how long a tick may take, what is
//! done if ticks leave no time to sleep, and when the loop hangs.

use std::time::Duration;

use fcc_runtime::{Budget, Overload};
use serde::{Deserialize, Serialize};

/// `[budget]`. An omitted budget means none, except for the tick's, which
/// defaults to the period.
#[derive(Clone, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct BudgetSection {
    /// The whole tick, from the wake-up to the last actuator write.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tick_us: Option<u32>,
    /// Sampling the sensors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensors_us: Option<u32>,
    /// The controller's `estimate`: navigation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimate_us: Option<u32>,
    /// The controller's `guide`: guidance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guide_us: Option<u32>,
    /// The controller's `control`, or `failsafe`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control_us: Option<u32>,
    /// Driving the actuators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub actuators_us: Option<u32>,
    /// The number of consecutive ticks that overrun or are missed that lead to
    /// failsafe; 0 for never. Default: half a second's ticks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failsafe_after: Option<u32>,
}

impl From<&BudgetSection> for Budget {
    fn from(section: &BudgetSection) -> Self {
        let time = |us: Option<u32>| us.map(|us| Duration::from_micros(us.into()));
        Self {
            tick: time(section.tick_us),
            sensors: time(section.sensors_us),
            estimate: time(section.estimate_us),
            guide: time(section.guide_us),
            control: time(section.control_us),
            actuators: time(section.actuators_us),
            failsafe_after: section.failsafe_after,
        }
    }
}

/// `[overload]`.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct OverloadSection {
    /// After this long without time to sleep, deadlines are skipped; 0 for never.
    pub skip_after_ms: u64,
    /// After this long without time to sleep, the controls are released and the
    /// program ends; 0 for never.
    pub stop_after_s: f64,
}

impl Default for OverloadSection {
    fn default() -> Self {
        let core = Overload::default();
        Self {
            skip_after_ms: core.skip_after.map_or(0, |after| after.as_millis() as u64),
            stop_after_s: core.stop_after.map_or(0.0, |after| after.as_secs_f64()),
        }
    }
}

impl From<&OverloadSection> for Overload {
    fn from(section: &OverloadSection) -> Self {
        let unless_never = |after: Duration| (!after.is_zero()).then_some(after);
        Self {
            skip_after: unless_never(Duration::from_millis(section.skip_after_ms)),
            stop_after: unless_never(Duration::from_secs_f64(section.stop_after_s)),
        }
    }
}

/// `[watchdog]`.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct WatchdogSection {
    /// Whether the program is ended when the loop hangs.
    pub enabled: bool,
    /// The loop counts as hung after this long without progress, or after four
    /// periods, if those are longer.
    pub hang_after_ms: u64,
}

/// Periods without progress that may be plain lateness.
const FEWEST_PERIODS: u32 = 4;

impl Default for WatchdogSection {
    fn default() -> Self {
        Self {
            enabled: true,
            hang_after_ms: 1_000,
        }
    }
}

impl WatchdogSection {
    /// How long a loop of this period may make no progress.
    pub fn hang_after(&self, period: Duration) -> Duration {
        Duration::from_millis(self.hang_after_ms).max(FEWEST_PERIODS * period)
    }
}
