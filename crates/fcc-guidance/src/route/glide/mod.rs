//! A glide without power to a landing place, and the way to its final.
//!
//! ```text
//! choose ─┬─► Key ─► Circle ─► Downwind
//!         │                       ▼
//!         ├───────────────────► Direct ─► Turn ─► Final ─► a landing without power
//!         │                       ▲                 │
//!         ├─────────► Round ──► Aside ◄─────────────┘
//!         └─► nothing is reached: into the wind, wings level, and down
//! ```
//!
//! Of the [sites](site) that are reached with height to spare the best is flown to, and
//! without height to spare the one with the most height left. High enough, the aircraft
//! circles over the [pattern](pattern)'s key; with less it flies onto the turn to the
//! final, whose length is chosen by the height. Between what the longest such way costs and
//! the key there is a gap as large as a circle costs: with so much height it flies away from
//! the landing's line until the way back costs what is left, and, where even more is left,
//! a circle before. Heights are those of energy: airspeed above that of the glide is height,
//! too.
//!
//! The glide ratio begins as configured, and is then the mean of the one that is flown: what
//! the propeller, the load and the air make of it.

mod choose;
mod fly;
mod follow;
mod pattern;
mod reach;
#[cfg(test)]
#[path = "tests/simulation.rs"]
mod simulation;
mod site;

pub use reach::Glide;

use nalgebra::Vector2;

use super::leg::Leg;
use super::runway::{Runway, RunwayFlight};
use super::{OverGround, Route, RouteConfig};
use crate::path::{LocalPlane, Motion};
use fcc_core::blocks::limit;
use fcc_core::units::GRAVITY_MPS2;
use fly::CIRCLE_SPARE;
use pattern::{Air, Pattern, course_of};

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
/// The configured glide counts as much as this time of a flown one, s, of which the last
/// minutes count, s: gusts rise and sink for ten seconds and more, and what is left of
/// them is the smaller the longer the mean is. It is flown while the airspeed is within
/// this share of that of the glide, and counts no farther off than by these factors.
const CONFIGURED_S: f64 = 60.0;
const LAST_S: f64 = 240.0;
const ON_SPEED: f64 = 0.1;
const FACTORS: (f64, f64) = (0.6, 2.0);
/// No turn over the ground is smaller, m.
const LEAST_RADIUS_M: f64 = 150.0;
/// On the way, another site is chosen if this one is missed by so much height, m.
const MISSED_M: f64 = 15.0;
/// Lower than this above the ground it turns no more, m.
const LEAST_TURNING_M: f64 = 25.0;
/// On the way so much of the height above that of the last turn, m, is kept: the air on the
/// way is not known.
const KEPT: f64 = 0.06;
const LAST_TURN_M: f64 = 150.0;
/// On a final that is higher by this it goes aside, m.
const HIGH_M: f64 = 20.0;

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
    /// A full circle, to lose more: where and on what course it began, and whether half of
    /// it is flown.
    Round(Vector2<f64>, Vector2<f64>, bool),
    /// In the turn onto a final of this length, m.
    Turn(f64),
    /// On the final, as long as there is room for another way.
    Final,
}

/// A glide that is flown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct GlideFlight {
    config: GlideConfig,
    /// The sine of the glide's angle, as configured and as flown.
    planned_sine: f64,
    sine: f64,
    /// For how long it was flown, s.
    flown_s: f64,
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

impl GlideFlight {
    pub(super) fn new(config: GlideConfig) -> Self {
        let sine = Glide::with_ratio(1.0, config.ratio).sink_mps;
        Self {
            config,
            planned_sine: sine,
            sine,
            flown_s: 0.0,
            energy_m: None,
            stage: Stage::Begin,
            at: LocalPlane::at(0.0, 0.0),
            elevation_m: 0.0,
            runway: None,
            pattern: Pattern {
                course: Vector2::new(1.0, 0.0),
                radius_m: LEAST_RADIUS_M,
                is_right: true,
                float_m: 0.0,
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
        self.flown_s = (self.flown_s + dt_s).min(LAST_S);
        let followed = self.sine + (level - self.sine) * dt_s / (CONFIGURED_S + self.flown_s);
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
        let is_on_way = matches!(
            self.stage,
            Stage::Key(_) | Stage::Direct(..) | Stage::Aside(..)
        );
        let is_missed = is_due && is_on_way && !self.aim(here, &motion);
        match self.stage {
            Stage::Begin => return self.choose(route, config, here),
            _ if is_missed => return self.choose(route, config, here),
            _ if self.is_low(route, config, here) => {
                let ground_m = site::ground_m(&route, config.return_height_m);
                return Some(self.ahead(ground_m, config, here));
            }
            Stage::Final if is_due && self.is_high(here, &motion) => {
                let (at_m, pattern) = (motion.position_m, self.pattern);
                if pattern.before_m(at_m) > pattern.shortest_m() + 2.0 * pattern.radius_m {
                    self.stage = Stage::Aside(at_m, pattern.aside());
                }
            }
            _ => {}
        }
        self.go_on(here, &motion, config)
    }

    /// Whether it is in the turn to its final, or on it.
    pub(super) const fn is_on_final(&self) -> bool {
        matches!(self.stage, Stage::Turn(_) | Stage::Final)
    }

    /// Computes the way to the site; whether it is reached.
    fn aim(&mut self, here: &OverGround, motion: &Motion) -> bool {
        let (at_m, course) = (motion.position_m, course_of(motion.ground_velocity_mps));
        let air = self.air(here, motion);
        let height_m = self.height_m(here, self.elevation_m);
        let pattern = self.pattern;
        let circle_m = pattern.circle_cost_m(&air);
        let spare_m = match self.stage {
            Stage::Key(_) => 0.0,
            _ => CIRCLE_SPARE * circle_m,
        };
        if pattern.key_cost_m(at_m, course, &air) + spare_m <= height_m {
            self.stage = pattern
                .key_leg(at_m)
                .map_or(Stage::Circle(false), Stage::Key);
            return true;
        }
        let shortest_m = pattern.shortest_m();
        let left_m = height_m - pattern.direct_cost_m(at_m, course, shortest_m, &air);
        if left_m < -MISSED_M {
            return false;
        }
        let Some(leg) = pattern.leg(at_m, shortest_m) else {
            return false;
        };
        let kept_m = KEPT * (height_m - LAST_TURN_M).max(0.0);
        let round_m = (1.0 + CIRCLE_SPARE) * circle_m + self.config.spare_m;
        self.stage = match pattern.final_for_m(height_m - kept_m, at_m, course, &air) {
            Some(final_m) => Stage::Direct(pattern.leg(at_m, final_m).unwrap_or(leg), final_m),
            None if left_m > round_m => Stage::Round(at_m, course, false),
            None => match self.stage {
                Stage::Aside(..) => self.stage,
                _ => Stage::Aside(at_m, pattern.aside()),
            },
        };
        true
    }

    /// Whether it is too low for another turn.
    fn is_low(&self, route: Route<'static>, config: &RouteConfig, here: &OverGround) -> bool {
        let ground_m = site::ground_m(&route, config.return_height_m);
        let height_m = here.height_m.unwrap_or(here.altitude_m - ground_m);
        self.stage != Stage::Final && height_m < LEAST_TURNING_M
    }

    /// Whether it would pass the aim, on the final.
    fn is_high(&self, here: &OverGround, motion: &Motion) -> bool {
        let final_m = self.pattern.before_m(motion.position_m);
        let costs_m = self.pattern.final_cost_m(final_m, &self.air(here, motion));
        self.height_m(here, self.elevation_m) > costs_m + HIGH_M
    }
}
