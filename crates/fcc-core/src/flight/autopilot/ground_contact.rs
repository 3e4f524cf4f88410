//! The wheels on the ground where neither a take-off nor a landing is flown.

use super::Autopilot;
use crate::flight::guidance::Mode;
use crate::flight::route::RunwayReason;

/// A range finder that shows more than this above what it shows on the wheels contradicts
/// their switch, m.
const CLEAR_M: f64 = 1.0;
/// It climbs off the ground by this much, m: the loops would push it onto the ground with ever
/// more elevator, and where that ends it would dive.
const CLIMBS_OFF_M: f64 = 10.0;

/// What is told once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ToldOnce {
    /// Whether the wheels were off the ground, since engaging or since that was told.
    has_flown: bool,
    /// The altitude above the ground that it touches, m: that of where it began to, as a switch
    /// that is stuck shows for ever.
    off_ground_m: Option<f64>,
    /// Whether the end of the plan is told.
    pub(super) end: bool,
}

impl Autopilot {
    /// An aircraft that is on its wheels, and is not to be, climbs; that it has flown before is
    /// announced. Where nothing measures the weight on the wheels nothing is known of it.
    pub(super) fn watch_ground_contact(&mut self) {
        let Some(on_wheels) = self.ground.on_wheels() else {
            return;
        };
        let is_clear = self.ground.here().and_then(|here| here.height_m);
        let on_wheels_m = self.config.route.runway.height_on_wheels_m;
        let is_clear = is_clear.is_some_and(|height_m| height_m > on_wheels_m + CLEAR_M);
        if !on_wheels || is_clear {
            self.told_once.has_flown = true;
            self.told_once.off_ground_m = None;
            return;
        }
        let is_expected = self.runway().is_some() || self.guidance.mode() == Mode::Glide;
        if !is_expected {
            let altitude_m = self.navigation.estimate().altitude_m;
            let off_ground_m = &mut self.told_once.off_ground_m;
            let off_ground_m = *off_ground_m.get_or_insert(altitude_m + CLIMBS_OFF_M);
            self.targets.altitude_m = self.targets.altitude_m.max(off_ground_m);
            if self.told_once.has_flown {
                self.on_runway.announce(RunwayReason::Touched);
            }
        }
        self.told_once.has_flown = false;
    }
}
