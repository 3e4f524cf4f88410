//! `[contingency]`: what the autopilot does by itself.

use fcc_core::units::FOOT_M;
use fcc_fixed_wing::{ContingencyAction, ContingencyConfig};
use serde::{Deserialize, Serialize};

use super::Config;

/// A revolution per minute, rad/s.
const RPM_RADPS: f64 = core::f64::consts::TAU / 60.0;

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
    /// Without the engine.
    pub engine_out: ActionChoice,
    /// It is out below this speed; none: not watched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine_out_below_rpm: Option<f64>,
    /// Where its speed is not measured: whether it is out if the throttle gives no thrust.
    pub engine_out_by_thrust: bool,
    /// After this time.
    pub engine_out_after_s: f64,
    /// It runs again when it was above that speed for this time.
    pub engine_back_after_s: f64,
    /// The way through still air over the height that is lost without power at
    /// `autopilot.envelope.best_glide_airspeed_kt`.
    pub glide_ratio: f64,
    /// Height to spare over a place that is glided to.
    pub glide_spare_ft: f64,
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
    /// Glide to the best place that is reached, and land there.
    Glide,
}

impl From<ActionChoice> for ContingencyAction {
    fn from(choice: ActionChoice) -> Self {
        match choice {
            ActionChoice::Continue => Self::Continue,
            ActionChoice::Loiter => Self::Loiter,
            ActionChoice::Return => Self::Return,
            ActionChoice::Land => Self::Land,
            ActionChoice::Glide => Self::Glide,
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
            engine_out: ActionChoice::Glide,
            engine_out_below_rpm: None,
            engine_out_by_thrust: false,
            engine_out_after_s: 2.0,
            engine_back_after_s: 5.0,
            glide_ratio: 9.0,
            glide_spare_ft: 200.0,
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
            engine: section.engine_out.into(),
            engine_below_radps: section.engine_out_below_rpm.map(|rpm| rpm * RPM_RADPS),
            engine_by_thrust: section.engine_out_by_thrust,
            engine_after_s: section.engine_out_after_s,
            engine_back_after_s: section.engine_back_after_s,
            glide_ratio: section.glide_ratio,
            glide_spare_m: section.glide_spare_ft * FOOT_M,
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
/// out; a glide is flown without an engine, and nothing else is.
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
    for (key, action) in [
        ("contingency.fence", section.fence),
        ("contingency.position_lost", section.position_lost),
        ("contingency.commander_lost", section.commander_lost),
        ("contingency.battery_low", section.battery_low),
    ] {
        if action == ActionChoice::Glide {
            let message = "is \"glide\", which is for engine_out: choose another action";
            report(&[key], message.to_owned());
        }
    }
    let engine = section.engine_out;
    if !matches!(engine, ActionChoice::Glide | ActionChoice::Continue) {
        let message = "needs power: choose \"glide\" or \"continue\"";
        report(&["contingency.engine_out"], message.to_owned());
    }
}
