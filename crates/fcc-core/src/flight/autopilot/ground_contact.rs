//! The wheels on the ground where neither a take-off nor a landing is flown.

use super::Autopilot;
use crate::flight::guidance::Mode;
use crate::flight::route::RunwayReason;

/// A range finder that shows more than this above what it shows on the wheels contradicts
/// their switch, m.
const CLEAR_M: f64 = 1.0;

/// What is told once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ToldOnce {
    /// Whether the wheels were off the ground, since engaging or since that was told.
    has_flown: bool,
    /// Whether the end of the plan is told.
    pub(super) end: bool,
}

impl Autopilot {
    /// Announces that an aircraft that has flown is on its wheels, and is not to be. Where
    /// nothing measures the weight on the wheels nothing is known of it.
    pub(super) fn watch_ground_contact(&mut self) {
        let Some(on_wheels) = self.ground.on_wheels() else {
            return;
        };
        let is_clear = self.ground.here().and_then(|here| here.height_m);
        let on_wheels_m = self.config.route.runway.height_on_wheels_m;
        let is_clear = is_clear.is_some_and(|height_m| height_m > on_wheels_m + CLEAR_M);
        if !on_wheels || is_clear {
            self.told_once.has_flown = true;
            return;
        }
        let is_expected = self.runway().is_some() || self.guidance.mode() == Mode::Glide;
        if self.told_once.has_flown && !is_expected {
            self.on_runway.announce(RunwayReason::Touched);
        }
        self.told_once.has_flown = false;
    }
}
