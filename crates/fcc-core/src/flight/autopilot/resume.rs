//! Taking up a flight that was cut off: by a crash, a kill or a watchdog.

use core::f64::consts::TAU;

use libm::round;

use super::Autopilot;
use crate::flight::Order;
use crate::flight::Surfaces;
use crate::flight::guidance::{GuidanceConfig, Targets, TimedPattern};

/// What was flown when a flight was cut off. Ordered right after engaging, it
/// puts the autopilot where it was.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Resume {
    /// What was aimed for; of a pattern, what it had captured. The heading is
    /// on the compass, 0..2π.
    pub targets: Targets,
    /// For how long the configured pattern had been flown by now, s; none if
    /// the targets are to be held.
    pub pattern_s: Option<f64>,
    /// The surfaces that flew the aircraft: whoever gave the controls back may
    /// have centred them since.
    pub surfaces: Surfaces,
}

impl Resume {
    fn is_valid(&self) -> bool {
        let Targets {
            airspeed_mps,
            heading_rad,
            altitude_m,
        } = self.targets;
        [airspeed_mps, heading_rad, altitude_m]
            .iter()
            .all(|target| target.is_finite())
            && self
                .pattern_s
                .is_none_or(|elapsed_s| elapsed_s.is_finite() && elapsed_s >= 0.0)
            && self.surfaces.is_valid()
    }
}

impl Order {
    /// Whether it ends a pattern that is flown.
    pub fn ends_pattern(&self) -> bool {
        match *self {
            Self::Airspeed(value) | Self::Heading(value) | Self::Altitude(value) => {
                value.is_finite()
            }
            Self::Resume(_) => false,
        }
    }
}

impl Autopilot {
    /// Takes up what was flown. The compass does not tell how often the
    /// aircraft has turned about: the heading that is aimed for now is taken
    /// within half a turn of where the nose points.
    pub(super) fn resume(&mut self, resume: &Resume) {
        if !resume.is_valid() {
            return;
        }
        let pattern = match (resume.pattern_s, self.config.guidance) {
            (None, _) => None,
            (Some(elapsed_s), GuidanceConfig::TimedPattern(config)) => {
                Some(TimedPattern::resume(config, resume.targets, elapsed_s))
            }
            // There is no such pattern here.
            (Some(_), GuidanceConfig::Hold) => return,
        };
        let aimed = pattern
            .as_ref()
            .map_or(resume.targets, TimedPattern::targets);
        let off_rad = self.navigation.estimate().heading_rad - aimed.heading_rad;
        let turns_rad = round(off_rad / TAU) * TAU;
        let airspeed_mps = resume.targets.airspeed_mps;
        let captured = Targets {
            airspeed_mps: self.config.envelope.allowed_airspeed(airspeed_mps),
            heading_rad: resume.targets.heading_rad + turns_rad,
            altitude_m: resume.targets.altitude_m,
        };
        self.pattern = pattern.map(|pattern| pattern.captured_at(captured));
        self.targets = self
            .pattern
            .as_ref()
            .map_or(captured, TimedPattern::targets);
        // What was captured is known as well as it ever will be.
        self.capture = None;
        self.take_over(&resume.surfaces);
    }
}
