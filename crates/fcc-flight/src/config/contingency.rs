//! `[contingency]`: what the autopilot does by itself.

use fcc_core::flight::{ContingencyAction, ContingencyConfig};
use fcc_core::units::FOOT_M;
use serde::{Deserialize, Serialize};

use super::Config;

/// `[contingency]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ContingencySection {
    /// Near the sides of the plan's fence.
    pub fence: ActionChoice,
    /// How far inside of them the aircraft stays.
    pub fence_margin_m: f64,
    /// How far above the fence's floor and below its ceiling.
    pub fence_height_margin_ft: f64,
    /// Without a position.
    pub position_lost: ActionChoice,
    /// After this time.
    pub position_lost_after_s: f64,
    /// When a commander has promised to be heard, and is not.
    pub commander_lost: ActionChoice,
    /// With a low battery, which prevents a take-off, too.
    pub battery_low: ActionChoice,
    /// It is low below this share of its charge; none: not watched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub battery_charge_percent: Option<f64>,
    /// It is low below this voltage; none: not watched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub battery_voltage_v: Option<f64>,
    /// After this time.
    pub battery_low_after_s: f64,
    /// Where the ground ahead cannot be climbed over; needs `terrain.folder`.
    pub terrain: ActionChoice,
    /// How far above the ground the aircraft stays.
    pub terrain_margin_m: f64,
    /// How far ahead it is looked for.
    pub terrain_ahead_s: f64,
}

/// Actions.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ActionChoice {
    /// Report it.
    Continue,
    /// Circle.
    Loiter,
    /// Return, and circle there.
    Return,
    /// Fly the nearest landing of the plan; return without one.
    Land,
}

impl From<ActionChoice> for ContingencyAction {
    fn from(choice: ActionChoice) -> Self {
        match choice {
            ActionChoice::Continue => Self::Continue,
            ActionChoice::Loiter => Self::Loiter,
            ActionChoice::Return => Self::Return,
            ActionChoice::Land => Self::Land,
        }
    }
}

impl Default for ContingencySection {
    fn default() -> Self {
        Self {
            fence: ActionChoice::Return,
            fence_margin_m: 30.0,
            fence_height_margin_ft: 30.0,
            position_lost: ActionChoice::Return,
            position_lost_after_s: 120.0,
            commander_lost: ActionChoice::Return,
            battery_low: ActionChoice::Return,
            battery_charge_percent: None,
            battery_voltage_v: None,
            battery_low_after_s: 10.0,
            terrain: ActionChoice::Return,
            terrain_margin_m: 30.0,
            terrain_ahead_s: 60.0,
        }
    }
}

impl From<&ContingencySection> for ContingencyConfig {
    fn from(section: &ContingencySection) -> Self {
        Self {
            fence: section.fence.into(),
            fence_margin_m: section.fence_margin_m,
            fence_height_margin_m: section.fence_height_margin_ft * FOOT_M,
            position: section.position_lost.into(),
            position_after_s: section.position_lost_after_s,
            commander: section.commander_lost.into(),
            battery: section.battery_low.into(),
            battery_charge: section
                .battery_charge_percent
                .map(|percent| percent / 100.0),
            battery_voltage_v: section.battery_voltage_v,
            battery_after_s: section.battery_low_after_s,
            terrain: section.terrain.into(),
            terrain_margin_m: section.terrain_margin_m,
            terrain_ahead_s: section.terrain_ahead_s,
        }
    }
}

impl ContingencySection {
    /// How far inside of the fence the aircraft turns away from it; none if it does not.
    pub(super) fn watched_margin_m(&self) -> Option<f64> {
        (self.fence != ActionChoice::Continue).then_some(self.fence_margin_m)
    }
}

/// A landing needs a position, and one that the fence or terrain is in the way of is no way
/// out.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let section = &config.contingency;
    for (key, action) in [
        ("contingency.fence", section.fence),
        ("contingency.position_lost", section.position_lost),
        ("contingency.terrain", section.terrain),
    ] {
        if action == ActionChoice::Land {
            let message = "is \"land\": choose \"continue\", \"loiter\" or \"return\"";
            report(&[key], message.to_owned());
        }
    }
}
