//! The active guidance mode, stored without heap.

use super::{
    Guidance, Hold, Mode, OverGroundMode, Progress, Targets, TimedPattern, TimedPatternConfig,
};
use crate::route::{OverGround, RunwayReason};
use fcc_navigation::Estimate;

/// The guidance mode after engaging.
///
/// ```
/// use fcc_guidance::{GuidanceConfig, Mode, TimedPatternConfig};
///
/// let config = GuidanceConfig::TimedPattern(TimedPatternConfig::default());
/// assert_eq!(config.mode(), Mode::TimedPattern);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum GuidanceConfig {
    /// Hold the captured values, until commanded otherwise.
    Hold,
    /// The timed pattern of the thesis.
    TimedPattern(TimedPatternConfig),
    /// Fly the plan of the configuration.
    Plan,
}

impl GuidanceConfig {
    /// Which mode it is.
    pub const fn mode(&self) -> Mode {
        match self {
            Self::Hold => Mode::Hold,
            Self::TimedPattern(_) => Mode::TimedPattern,
            Self::Plan => Mode::Plan,
        }
    }
}

/// The active guidance mode. A new mode needs a variant in this file and in
/// [`Mode`].
///
/// ```
/// use fcc_guidance::{ActiveMode, GuidanceConfig, Mode, Targets};
///
/// let captured = Targets { airspeed_mps: 51.4, heading_rad: 0.0, altitude_m: 914.4 };
/// let active = ActiveMode::enter(Mode::Hold, &GuidanceConfig::Hold, captured);
/// assert_eq!(active.targets(), Some(captured));
/// assert_eq!(active.progress().mode, Mode::Hold);
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[allow(clippy::large_enum_variant, reason = "there is no heap, and one of it")]
pub enum ActiveMode {
    /// No mode is active.
    #[default]
    None,
    /// The captured values are held.
    Hold(Hold),
    /// The timed pattern.
    TimedPattern(TimedPattern),
    /// A route over the ground.
    OverGround(OverGroundMode),
}

/// Evaluates an expression for the active mode, or another without one.
macro_rules! of_mode {
    ($active:expr, $mode:ident => $of:expr, none => $none:expr) => {
        match $active {
            ActiveMode::None => $none,
            ActiveMode::Hold($mode) => $of,
            ActiveMode::TimedPattern($mode) => $of,
            ActiveMode::OverGround($mode) => $of,
        }
    };
}

impl ActiveMode {
    /// Continues the mode of a progress. No mode is active if that mode is not
    /// configured, or needs a route.
    pub fn resume(config: &GuidanceConfig, progress: &Progress) -> Self {
        match (progress.mode, config) {
            (Mode::Hold, _) => Self::Hold(Hold::resume((), progress)),
            (Mode::TimedPattern, GuidanceConfig::TimedPattern(config)) => {
                Self::TimedPattern(TimedPattern::resume(*config, progress))
            }
            _ => Self::None,
        }
    }

    /// Begins a mode now, with the captured targets.
    pub fn enter(mode: Mode, config: &GuidanceConfig, captured: Targets) -> Self {
        let progress = Progress {
            mode,
            captured,
            ..Progress::default()
        };
        Self::resume(config, &progress)
    }

    /// Which mode it is.
    pub fn mode(&self) -> Mode {
        self.progress().mode
    }

    /// The present targets; none if no mode is active.
    pub fn targets(&self) -> Option<Targets> {
        of_mode!(self, mode => Some(mode.targets()), none => None)
    }

    /// See [`Guidance::advance`]; where the aircraft is, if it is known, and the
    /// pressure altitude of mean sea level, m.
    pub fn advance(
        &mut self,
        estimate: &Estimate,
        here: Option<&OverGround>,
        sea_level_m: f64,
        dt_s: f64,
    ) {
        match self {
            Self::None => {}
            Self::Hold(mode) => mode.advance(estimate, dt_s),
            Self::TimedPattern(mode) => mode.advance(estimate, dt_s),
            Self::OverGround(mode) => mode.advance(estimate, here, sea_level_m, dt_s),
        }
    }

    /// The mode that flies over the ground, if it is one.
    pub const fn over_ground(&self) -> Option<&OverGroundMode> {
        match self {
            Self::OverGround(mode) => Some(mode),
            _ => None,
        }
    }

    /// Gives a landing, or the roll of a take-off, up for a reason.
    pub fn go_around(&mut self, reason: RunwayReason) {
        if let Self::OverGround(mode) = self {
            mode.go_around(reason);
        }
    }

    /// Its progress.
    pub fn progress(&self) -> Progress {
        of_mode!(self, mode => mode.progress(), none => Progress::default())
    }

    /// See [`Guidance::shift_altitude`]. A route's altitudes are above mean sea level,
    /// whatever was captured.
    pub fn shift_altitude(&mut self, by_m: f64) {
        match self {
            Self::None | Self::OverGround(_) => {}
            Self::Hold(mode) => mode.shift_altitude(by_m),
            Self::TimedPattern(mode) => mode.shift_altitude(by_m),
        }
    }
}
