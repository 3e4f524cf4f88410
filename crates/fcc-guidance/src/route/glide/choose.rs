//! Which place is glided to, and what is done where none is reached.

use super::pattern::{Pattern, blows, course_of};
use super::site::{self, Site, SiteKind};
use super::{GlideFlight, LEAST_RADIUS_M, Stage};
use crate::path::turn::smallest_circle_m;
use crate::path::{Motion, length};
use crate::route::runway::{Runway, RunwayFlight};
use crate::route::{OverGround, PLANNED_SHARE, Route, RouteConfig};

/// So many sites are compared in a tick; more are not near one another.
const MOST_SITES: usize = 16;
/// Lower than this it does not turn into the wind, where no site is reached, m.
const LEAST_TURN_M: f64 = 150.0;
/// The flare lasts 4.9 s longer than the glide from its height would: from 8.8 m with 3.7 m/s
/// and a time constant of 2.5 s, 2.5 ln(8.8/0.5 + 1) - 8.8/3.7.
const FLOATS_S: f64 = 4.9;

/// A site that is reached, and how.
#[derive(Clone, Copy)]
struct Choice {
    rank: (bool, SiteKind, f64),
    runway: Runway,
    pattern: Pattern,
    motion: Motion,
}

impl GlideFlight {
    /// Chooses a site; without one, the landing ahead.
    pub(super) fn choose(
        &mut self,
        route: Route<'static>,
        config: &RouteConfig,
        here: &OverGround,
    ) -> Option<RunwayFlight> {
        let ground_m = site::ground_m(&route, config.return_height_m);
        let mut best: Option<Choice> = None;
        let mut compared = 0;
        for (site, motion) in site::of(route, ground_m, *here) {
            let air = self.air(here, &motion);
            let height_m = self.height_m(here, site.elevation_m);
            // With the wind, without a turn.
            let fastest_mps = air.glide.true_airspeed_mps + length(air.wind_mps);
            let range_m = height_m * fastest_mps / air.glide.sink_mps;
            if length(motion.position_m) > range_m || compared == MOST_SITES {
                continue;
            }
            compared += 1;
            for is_right in [true, false] {
                let choice = self.choice(&site, motion, is_right, config, here);
                if choice.rank.2 > 0.0 && best.is_none_or(|best| choice.rank > best.rank) {
                    best = Some(choice);
                }
            }
        }
        let Some(choice) = best else {
            // The one that it has flown to is the nearest there is.
            return match self.runway {
                Some(_) => {
                    self.fly_to_final(here, self.pattern.shortest_m());
                    None
                }
                None => Some(self.ahead(ground_m, config, here)),
            };
        };
        self.at = choice.runway.at;
        self.elevation_m = choice.runway.elevation_m;
        self.runway = Some(choice.runway);
        self.pattern = choice.pattern;
        if !self.aim(here, &choice.motion) {
            self.fly_to_final(here, self.pattern.shortest_m());
        }
        None
    }

    /// Onto the turn to a final of this length, m.
    pub(super) fn fly_to_final(&mut self, here: &OverGround, final_m: f64) {
        let at_m = here.motion_in(&self.at).position_m;
        self.stage = match self.pattern.leg(at_m, final_m) {
            Some(leg) => Stage::Direct(leg, final_m),
            None => Stage::Turn(final_m),
        };
    }

    fn choice(
        &self,
        site: &Site,
        motion: Motion,
        is_right: bool,
        config: &RouteConfig,
        here: &OverGround,
    ) -> Choice {
        let air = self.air(here, &motion);
        let runway = site.runway(&motion);
        let bank_rad = libm::atan(PLANNED_SHARE * libm::tan(config.bank_rad));
        let along_mps = air.glide.true_airspeed_mps + runway.course.dot(&motion.wind_mps);
        let radius_m = smallest_circle_m(
            air.glide.true_airspeed_mps,
            length(motion.wind_mps),
            bank_rad,
        );
        let pattern = Pattern {
            course: runway.course,
            radius_m: radius_m.unwrap_or(f64::INFINITY).max(LEAST_RADIUS_M),
            is_right,
            float_m: FLOATS_S * along_mps.max(0.0) + site.short_m,
        };
        let course = course_of(motion.ground_velocity_mps);
        let shortest_m = pattern.shortest_m();
        let direct_m = pattern.direct_cost_m(motion.position_m, course, shortest_m, &air);
        let by_key_m = pattern.key_cost_m(motion.position_m, course, &air);
        let height_m = self.height_m(here, runway.elevation_m);
        let left_m = height_m - direct_m.min(by_key_m);
        // On the way there what was to spare is used up.
        let spare_m = if self.runway.is_some_and(|chosen| chosen.at == runway.at) {
            0.0
        } else {
            self.config.spare_m
        };
        Choice {
            rank: (left_m >= spare_m, site.kind, left_m),
            runway,
            pattern,
            motion,
        }
    }

    pub(super) fn land(
        &self,
        runway: Runway,
        here: &OverGround,
        config: &RouteConfig,
    ) -> RunwayFlight {
        let airspeed_mps = self.config.airspeed_mps;
        RunwayFlight::powerless(runway, here, config.runway, airspeed_mps, self.sine)
    }

    /// The landing where no site is reached: into the wind, or, low, straight ahead.
    pub(super) fn ahead(
        &self,
        ground_m: f64,
        config: &RouteConfig,
        here: &OverGround,
    ) -> RunwayFlight {
        let is_low = here.altitude_m - ground_m < LEAST_TURN_M
            || here.height_m.is_some_and(|above_m| above_m < LEAST_TURN_M);
        let course = if blows(here.wind_mps) && !is_low {
            -course_of(here.wind_mps)
        } else {
            course_of(here.ground_velocity_mps)
        };
        let runway = Runway {
            at: here.plane(),
            course,
            elevation_m: ground_m,
        };
        self.land(runway, here, config)
    }
}
