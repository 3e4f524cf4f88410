//! `[contingency]`: what the autopilot does by itself.

use fcc_core::flight::{ContingencyAction, ContingencyConfig};
use fcc_core::units::FOOT_M;
use serde::{Deserialize, Serialize};

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
}

impl From<ActionChoice> for ContingencyAction {
    fn from(choice: ActionChoice) -> Self {
        match choice {
            ActionChoice::Continue => Self::Continue,
            ActionChoice::Loiter => Self::Loiter,
            ActionChoice::Return => Self::Return,
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
        }
    }
}

impl ContingencySection {
    /// How far inside of the fence the aircraft turns away from it; none if it does not.
    pub(super) fn watched_margin_m(&self) -> Option<f64> {
        (self.fence != ActionChoice::Continue).then_some(self.fence_margin_m)
    }
}
