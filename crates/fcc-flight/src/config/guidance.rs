//! `[guidance]`: the mode after engaging.

use fcc_core::units::FOOT_M;
use fcc_guidance::{GuidanceConfig, TimedPatternConfig};
use serde::{Deserialize, Serialize};

const HOLD_S: f64 = 20.0;
const LEG_S: f64 = 20.0;
const TURN_DEG: f64 = 90.0;
const CLIMB_FT: f64 = 150.0;

/// `[guidance]`: the mode after engaging.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(try_from = "Keys", tag = "mode", rename_all = "kebab-case")]
pub enum GuidanceSection {
    /// Hold the captured values.
    Hold,
    /// The flight plan of `[plan]`.
    Plan,
    /// The timed pattern of the thesis.
    TimedPattern {
        /// How long to hold the captured values.
        hold_s: f64,
        /// How long each leg takes.
        leg_s: f64,
        /// Turn of each leg, right if positive.
        turn_deg: f64,
        /// Climb of every odd leg, taken back in every even one.
        climb_ft: f64,
    },
}

/// The section as it is written: flat, so that an error is reported for its
/// key.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    mode: Mode,
    hold_s: Option<f64>,
    leg_s: Option<f64>,
    turn_deg: Option<f64>,
    climb_ft: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Mode {
    Hold,
    Plan,
    TimedPattern,
}

impl TryFrom<Keys> for GuidanceSection {
    type Error = &'static str;

    fn try_from(keys: Keys) -> Result<Self, Self::Error> {
        let patterns = [keys.hold_s, keys.leg_s, keys.turn_deg, keys.climb_ft];
        match keys.mode {
            Mode::Hold | Mode::Plan if patterns.iter().any(Option::is_some) => Err(
                "a hold and a plan have no hold_s, leg_s, turn_deg or climb_ft: take them out, or choose \
                 mode = \"timed-pattern\"",
            ),
            Mode::Hold => Ok(Self::Hold),
            Mode::Plan => Ok(Self::Plan),
            Mode::TimedPattern => Ok(Self::TimedPattern {
                hold_s: keys.hold_s.unwrap_or(HOLD_S),
                leg_s: keys.leg_s.unwrap_or(LEG_S),
                turn_deg: keys.turn_deg.unwrap_or(TURN_DEG),
                climb_ft: keys.climb_ft.unwrap_or(CLIMB_FT),
            }),
        }
    }
}

/// Legs flown by default.
const DEFAULT_LEGS: f64 = 8.0;
/// Duration of a flight without a pattern by default, s.
const DEFAULT_HOLD_S: f64 = 60.0;

impl GuidanceSection {
    /// How long an aircraft is flown by default, s from engaging on.
    pub fn default_length_s(&self) -> f64 {
        match self {
            Self::Hold | Self::Plan => DEFAULT_HOLD_S,
            Self::TimedPattern { hold_s, leg_s, .. } => hold_s + DEFAULT_LEGS * leg_s,
        }
    }
}

impl Default for GuidanceSection {
    fn default() -> Self {
        Self::TimedPattern {
            hold_s: HOLD_S,
            leg_s: LEG_S,
            turn_deg: TURN_DEG,
            climb_ft: CLIMB_FT,
        }
    }
}

impl From<&GuidanceSection> for GuidanceConfig {
    fn from(section: &GuidanceSection) -> Self {
        match *section {
            GuidanceSection::Hold => Self::Hold,
            GuidanceSection::Plan => Self::Plan,
            GuidanceSection::TimedPattern {
                hold_s,
                leg_s,
                turn_deg,
                climb_ft,
            } => Self::TimedPattern(TimedPatternConfig {
                hold_s,
                leg_s,
                turn_rad: turn_deg.to_radians(),
                climb_m: climb_ft * FOOT_M,
            }),
        }
    }
}
