//! Where a take-off may begin.

use super::super::Autopilot;
use fcc_core::framework::Time;
use fcc_guidance::Mode;
use fcc_guidance::path::{LocalPlane, length};
use fcc_guidance::route::{Runway, Step};

/// A take-off begins again within this distance of where the last one did, m.
const AT_BEGIN_M: f64 = 100.0;
/// Farther away is another runway, m: the longest paved one has 5.5 km.
const LONGEST_RUNWAY_M: f64 = 6_000.0;

impl Autopilot {
    /// Whether it may engage standing on a runway: the plan begins with a take-off.
    pub(in super::super) fn begins_on_runway(&self) -> bool {
        self.first_takeoff().is_some() && self.waits_for_takeoff()
    }

    /// Whether engaging would begin a take-off in a roll, or from where a landing ended.
    pub(in super::super) fn may_not_take_off_here(&self, now: Time) -> bool {
        let Some(Step::Takeoff { runway, .. }) = self.first_takeoff() else {
            return false;
        };
        !self.config.route.runway.is_thrown()
            && self.estimator.ground.stands_on_wheels()
            && (self.estimator.ground.moves(now) || self.is_beyond_takeoff(*runway))
    }

    /// Whether it stands on the runway from which it took off, but elsewhere along it,
    /// and not where the plan's runway begins either.
    fn is_beyond_takeoff(&self, runway: Option<Runway>) -> bool {
        let (Some(here), Some(took_off)) = (self.estimator.ground.here(), self.supervisor.took_off)
        else {
            return false;
        };
        let here = here.plane();
        let off_m = |at: &LocalPlane| length(at.origin_of_m(&here));
        let began = LocalPlane::at(took_off.latitude_rad, took_off.longitude_rad);
        let is_at_begin = runway.is_some_and(|runway| off_m(&runway.at) < AT_BEGIN_M);
        (AT_BEGIN_M..LONGEST_RUNWAY_M).contains(&off_m(&began)) && !is_at_begin
    }

    /// The take-off with which the plan begins that engaging flies.
    fn first_takeoff(&self) -> Option<&'static Step> {
        let steps = self.config.plan.map_or(&[][..], |plan| plan.steps);
        let first = steps.iter().find(|step| step.is_flown());
        first.filter(|step| {
            matches!(step, Step::Takeoff { .. }) && self.config.guidance.mode() == Mode::Plan
        })
    }
}
