//! A glide without power to a landing place, and the way to its final.
//!
//! ```text
//! choose ─┬─► Key ─► Circle ─► Downwind ─┐
//!         ├─► Direct ◄─► Aside           ├─► Turn ─► final: a landing without power
//!         │      └───────────────────────┘
//!         └─► nothing is reached: into the wind, wings level, and down
//! ```
//!
//! Of the [sites](site) that are reached with height to spare the best is flown to, and
//! without height to spare the one with the most height left. High enough, the aircraft
//! circles over the [pattern](pattern)'s key; with less it flies onto the turn to the
//! final, whose length is chosen by the height, or aside until it fits. Heights are those
//! of energy: airspeed above that of the glide is height, too.
//!
//! The glide ratio begins as configured, and is then the one that is flown: what the
//! propeller, the load and the air make of it.

mod pattern;
mod reach;
mod site;

pub use reach::Glide;

use libm::exp;
use nalgebra::Vector2;

use super::leg::Leg;
use super::runway::{Runway, RunwayFlight};
use super::{OverGround, PLANNED_SHARE, ROLL_LAG_S, Route, RouteConfig};
use crate::blocks::limit;
use crate::flight::path::turn::smallest_circle_m;
use crate::flight::path::{LocalPlane, Motion, Path, length};
use crate::units::GRAVITY_MPS2;
use pattern::{Air, Pattern, blows, course_of};
use site::{Site, SiteKind};

/// How the aircraft glides.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GlideConfig {
    /// Indicated airspeed of the best glide, m/s.
    pub airspeed_mps: f64,
    /// The way through the air at that airspeed over the height that is lost.
    pub ratio: f64,
    /// Height to spare over a place, m.
    pub spare_m: f64,
}

/// How often the way is computed anew, s.
const EVERY_S: f64 = 0.5;
/// The flown glide is followed with this time constant, s, while the airspeed is within
/// this share of that of the glide, and no farther than by these factors.
const FOLLOWS_S: f64 = 40.0;
const ON_SPEED: f64 = 0.1;
const FACTORS: (f64, f64) = (0.6, 2.0);
/// No turn over the ground is smaller, m.
const LEAST_RADIUS_M: f64 = 150.0;
/// So many sites are compared in a tick; more are not near one another.
const MOST_SITES: usize = 16;
/// On the way, another site is chosen if this one is missed by so much height, m.
const MISSED_M: f64 = 15.0;
/// Where height is lost aside, the course is so far off, as cosine and sine (60°).
const ASIDE: (f64, f64) = (0.5, 0.866);
/// Lower than this it does not turn into the wind, where no site is reached, m.
const LEAST_TURN_M: f64 = 150.0;

#[derive(Clone, Copy, PartialEq, Debug)]
enum Stage {
    /// A site is to be chosen.
    Begin,
    /// On the leg onto the circle over the key.
    Key(Leg),
    /// On that circle; whether it led away from the landing's line.
    Circle(bool),
    /// Opposite to the landing.
    Downwind,
    /// On the leg onto the turn to a final of this length, m.
    Direct(Leg, f64),
    /// Aside, to lose height, from a place on a course.
    Aside(Vector2<f64>, Vector2<f64>),
    /// In the turn onto a final of this length, m.
    Turn(f64),
}

/// A glide that is flown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct GlideFlight {
    config: GlideConfig,
    /// The sine of the glide's angle, as configured and as flown.
    planned_sine: f64,
    sine: f64,
    /// Height of energy in the last tick, m.
    energy_m: Option<f64>,
    stage: Stage,
    pub(super) at: LocalPlane,
    pub(super) elevation_m: f64,
    runway: Option<Runway>,
    pattern: Pattern,
    /// When the way is computed anew, s.
    next_s: f64,
}

/// A site that is reached, and how.
#[derive(Clone, Copy)]
struct Choice {
    rank: (bool, SiteKind, f64),
    runway: Runway,
    pattern: Pattern,
    motion: Motion,
}

impl GlideFlight {
    pub(super) fn new(config: GlideConfig) -> Self {
        let sine = Glide::with_ratio(1.0, config.ratio).sink_mps;
        Self {
            config,
            planned_sine: sine,
            sine,
            energy_m: None,
            stage: Stage::Begin,
            at: LocalPlane::at(0.0, 0.0),
            elevation_m: 0.0,
            runway: None,
            pattern: Pattern {
                course: Vector2::new(1.0, 0.0),
                radius_m: LEAST_RADIUS_M,
                is_right: true,
            },
            next_s: 0.0,
        }
    }

    pub(super) const fn airspeed_mps(&self) -> f64 {
        self.config.airspeed_mps
    }

    /// The true airspeed of the glide here, m/s.
    fn true_airspeed_mps(&self, here: &OverGround) -> f64 {
        let ratio = here.true_airspeed_mps / here.airspeed_mps.max(1.0);
        self.config.airspeed_mps * limit(ratio, 1.0, 2.0)
    }

    fn air(&self, here: &OverGround, motion: &Motion) -> Air {
        let true_airspeed_mps = self.true_airspeed_mps(here);
        Air {
            glide: Glide {
                true_airspeed_mps,
                sink_mps: self.sine * true_airspeed_mps,
            },
            wind_mps: motion.wind_mps,
        }
    }

    /// The height over an elevation, m, with that of the airspeed.
    fn height_m(&self, here: &OverGround, elevation_m: f64) -> f64 {
        let (now, glide) = (here.true_airspeed_mps, self.true_airspeed_mps(here));
        here.altitude_m - elevation_m + (now * now - glide * glide) / (2.0 * GRAVITY_MPS2)
    }

    /// Follows the glide that is flown.
    fn follow(&mut self, here: &OverGround, dt_s: f64) {
        let speed_mps = here.true_airspeed_mps;
        let energy_m = here.altitude_m + speed_mps * speed_mps / (2.0 * GRAVITY_MPS2);
        let before_m = self.energy_m.replace(energy_m);
        let off = here.airspeed_mps / self.config.airspeed_mps - 1.0;
        let Some(before_m) = before_m.filter(|_| off.abs() < ON_SPEED) else {
            return;
        };
        let load = 1.0 / libm::cos(limit(here.roll_rad, -1.0, 1.0));
        let level = (before_m - energy_m) / (dt_s * speed_mps * 0.5 * (1.0 + load * load));
        let followed = self.sine + (level - self.sine) * (1.0 - exp(-dt_s / FOLLOWS_S));
        let (least, most) = FACTORS;
        self.sine = limit(
            followed,
            least * self.planned_sine,
            most * self.planned_sine,
        );
    }

    /// One tick; the landing, when its final is reached.
    pub(super) fn step(
        &mut self,
        route: Route<'static>,
        config: &RouteConfig,
        here: &OverGround,
        dt_s: f64,
    ) -> Option<RunwayFlight> {
        self.follow(here, dt_s);
        self.next_s -= dt_s;
        let is_due = self.next_s <= 0.0;
        if is_due {
            self.next_s = EVERY_S;
        }
        let motion = here.motion_in(&self.at);
        match self.stage {
            Stage::Begin => return self.choose(route, config, here),
            Stage::Key(_) | Stage::Direct(..) | Stage::Aside(..) if is_due => {
                if !self.aim(here, &motion) {
                    return self.choose(route, config, here);
                }
            }
            _ => {}
        }
        self.go_on(here, &motion, config)
    }

    /// Chooses a site; without one, the landing ahead.
    fn choose(
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
            return Some(self.ahead(ground_m, config, here));
        };
        self.at = choice.runway.at;
        self.elevation_m = choice.runway.elevation_m;
        self.runway = Some(choice.runway);
        self.pattern = choice.pattern;
        if !self.aim(here, &choice.motion) {
            return Some(self.ahead(ground_m, config, here));
        }
        None
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
        let radius_m = smallest_circle_m(
            air.glide.true_airspeed_mps,
            length(motion.wind_mps),
            bank_rad,
        );
        let pattern = Pattern {
            course: runway.course,
            radius_m: radius_m.unwrap_or(f64::INFINITY).max(LEAST_RADIUS_M),
            is_right,
        };
        let course = course_of(motion.ground_velocity_mps);
        let shortest_m = pattern.shortest_m();
        let direct_m = pattern.direct_cost_m(motion.position_m, course, shortest_m, &air);
        let by_key_m = pattern.key_cost_m(motion.position_m, course, &air);
        let height_m = self.height_m(here, runway.elevation_m);
        let left_m = height_m - direct_m.min(by_key_m);
        Choice {
            rank: (left_m >= self.config.spare_m, site.kind, left_m),
            runway,
            pattern,
            motion,
        }
    }

    /// Computes the way to the site; whether it is reached.
    fn aim(&mut self, here: &OverGround, motion: &Motion) -> bool {
        let (at_m, course) = (motion.position_m, course_of(motion.ground_velocity_mps));
        let air = self.air(here, motion);
        let height_m = self.height_m(here, self.elevation_m);
        let pattern = self.pattern;
        if pattern.key_cost_m(at_m, course, &air) <= height_m {
            self.stage = pattern
                .leg(at_m, 0.0)
                .map_or(Stage::Circle(false), Stage::Key);
            return true;
        }
        let shortest_m = pattern.shortest_m();
        if pattern.direct_cost_m(at_m, course, shortest_m, &air) > height_m + MISSED_M {
            return false;
        }
        let Some(leg) = pattern.leg(at_m, shortest_m) else {
            return false;
        };
        self.stage = match pattern.final_for_m(height_m, at_m, course, &air) {
            Some(final_m) => Stage::Direct(pattern.leg(at_m, final_m).unwrap_or(leg), final_m),
            None => {
                let (along, across) = ASIDE;
                let right = crate::flight::path::right_of(leg.course);
                let away = if pattern.is_right { across } else { -across };
                Stage::Aside(at_m, leg.course * along + right * away)
            }
        };
        true
    }

    fn go_on(
        &mut self,
        here: &OverGround,
        motion: &Motion,
        config: &RouteConfig,
    ) -> Option<RunwayFlight> {
        let (at_m, pattern) = (motion.position_m, self.pattern);
        let ahead_m = ahead_m(motion, config);
        match self.stage {
            Stage::Key(leg) if leg.left_m(at_m) <= ahead_m => self.stage = Stage::Circle(false),
            Stage::Circle(was_outward) => {
                let left_rad = pattern.left_rad(0.0, at_m, -pattern.course);
                let is_outward =
                    left_rad > ahead_m / pattern.radius_m && left_rad < core::f64::consts::PI;
                self.stage = Stage::Circle(is_outward);
                if was_outward && !is_outward {
                    let air = self.air(here, motion);
                    let height_m = self.height_m(here, self.elevation_m);
                    let needs_m = pattern.circle_cost_m(&air) + pattern.low_key_cost_m(0.0, &air);
                    if height_m < needs_m {
                        self.stage = Stage::Downwind;
                    }
                }
            }
            Stage::Downwind => {
                let before_m = pattern.before_m(at_m) + ahead_m;
                let air = self.air(here, motion);
                let height_m = self.height_m(here, self.elevation_m);
                let is_far = before_m >= pattern.shortest_m();
                if is_far && pattern.low_key_cost_m(before_m, &air) >= height_m
                    || before_m >= pattern.longest_m()
                {
                    self.stage = Stage::Turn(before_m);
                }
            }
            Stage::Direct(leg, final_m) if leg.left_m(at_m) <= ahead_m => {
                self.stage = Stage::Turn(final_m);
            }
            Stage::Turn(final_m) => {
                let left_rad = pattern.left_rad(final_m, at_m, pattern.course);
                let is_over = left_rad <= ahead_m / pattern.radius_m
                    || left_rad > core::f64::consts::TAU - 0.5;
                if is_over && let Some(runway) = self.runway {
                    return Some(self.land(runway, here, config));
                }
            }
            _ => {}
        }
        None
    }

    fn land(&self, runway: Runway, here: &OverGround, config: &RouteConfig) -> RunwayFlight {
        let airspeed_mps = self.config.airspeed_mps;
        RunwayFlight::powerless(runway, here, config.runway, airspeed_mps, self.sine)
    }

    /// The landing where no site is reached: into the wind, or, low, straight ahead.
    fn ahead(&self, ground_m: f64, config: &RouteConfig, here: &OverGround) -> RunwayFlight {
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

    /// What is followed.
    pub(super) fn path(&self) -> Path {
        match self.stage {
            Stage::Key(leg) | Stage::Direct(leg, _) => leg.path(),
            Stage::Begin | Stage::Circle(_) => self.pattern.circle(0.0),
            Stage::Downwind => self.pattern.downwind(),
            Stage::Aside(through_m, course) => Path::Line { through_m, course },
            Stage::Turn(final_m) => self.pattern.circle(final_m),
        }
    }
}

/// How far before an arc its bank is commanded, m.
fn ahead_m(motion: &Motion, config: &RouteConfig) -> f64 {
    let ramp_s = config.bank_rad / config.bank_rate_radps;
    length(motion.ground_velocity_mps) * (0.5 * ramp_s + ROLL_LAG_S)
}
