//! Terrain ahead: climbed over in time, or turned away from.
//!
//! The ground ahead says how high the aircraft has to be now, so that a climb with a part
//! of its performance clears all of it: that is the lowest altitude of what is flown, and
//! the mode goes on. What no climb clears is turned away from onto a circle, when the last
//! one that is clear of the ground is about to be lost.

use libm::{cos, sin, tan};
use nalgebra::Vector2;

use super::super::Autopilot;
use super::fence::FASTER_MPS;
use super::surface::Surface;
use super::{CONTINGENCY, Contingency, ContingencyAction, Stage, notice};
use fcc_core::framework::{Notice, PERMILLE};
use fcc_core::units::GRAVITY_MPS2;
use fcc_guidance::fence::{Escape, Fence};
use fcc_guidance::path::length;
use fcc_guidance::route::OverGround;
use fcc_guidance::{Mode, ModeInput};

/// Points of the way ahead, m apart, and what is seen around each.
const STEP_M: f64 = 100.0;
const REACH_M: f64 = 60.0;
/// The same of a circle, which moves with the aircraft until it is turned onto.
const CIRCLE_STEP_M: f64 = 200.0;
const CIRCLE_REACH_M: f64 = 150.0;
/// How far circles may be away, m, for obstacles.
const CIRCLES_M: f64 = 3_000.0;
/// Of the largest climb, with what is reckoned, and what there is at most; and how long
/// it takes to begin, s.
const CLIMB_SHARE: f64 = 0.6;
const MOST_SHARE: f64 = 0.9;
const BEGINS_S: f64 = 5.0;
/// Of the margin, what is left where a climb lags behind.
const LAG_SHARE: f64 = 0.5;
/// Where no circle was clear before, it turns away so long before the ground, s.
const LAST_S: f64 = 20.0;
/// A bank below this is none, rad: 3°.
const LEVEL_RAD: f64 = 0.052;
/// A climb is told when the target altitude is raised by more than this, m; and its end
/// after so long without one, s.
const RAISED_M: f64 = 1.0;
const OVER_S: f64 = 10.0;
/// What is done, in a notice.
pub(super) const CLIMBS: u16 = 100;
pub(super) const PASSED: u16 = 101;

/// The watch over the ground ahead.
#[derive(Clone, Copy, Debug, Default)]
pub(in super::super) struct TerrainWatch {
    /// The lowest altitude above mean sea level, as the altimeter shows it, from which what is
    /// ahead can be climbed over, m.
    lowest_m: Option<f64>,
    /// For how long it has been climbed over that, or not, s; none while it is not told.
    climbs_s: Option<f64>,
    /// The last circle that was clear of the ground since it is ahead: whether it is flown
    /// clockwise.
    had_circle: Option<bool>,
    /// Whether what is ahead, with the present bank or without one, cannot be climbed over.
    pub(super) is_in_the_way: bool,
}

/// The way ahead, with the present bank, or without one.
struct Ahead<'a> {
    surface: &'a Surface<'a>,
    here: &'a OverGround,
    course_rate_radps: f64,
    ahead_s: f64,
    margin_m: f64,
}

/// What the ground ahead needs.
#[derive(Clone, Copy, Debug)]
struct Needed {
    /// The altitude above mean sea level that is needed now, m.
    now_m: f64,
    /// The highest that is needed, m, and when the aircraft is there first, s.
    highest_m: f64,
    first_s: f64,
}

impl Ahead<'_> {
    /// What is needed with a climb rate, m/s. What is not known needs nothing.
    fn needs(&self, climb_mps: f64) -> Needed {
        let velocity = self.here.ground_velocity_mps;
        let dt_s = STEP_M / length(velocity).max(1.0);
        let (sine, cosine) = (
            sin(self.course_rate_radps * dt_s),
            cos(self.course_rate_radps * dt_s),
        );
        let mut needed = Needed {
            now_m: f64::NEG_INFINITY,
            highest_m: f64::NEG_INFINITY,
            first_s: f64::INFINITY,
        };
        let (mut at_m, mut way, mut t_s) = (Vector2::zeros(), velocity, 0.0);
        while t_s <= self.ahead_s {
            if let Some(ground_m) = self.surface.highest_m(at_m, REACH_M) {
                let over_m = ground_m + self.margin_m;
                let now_m = over_m - climb_mps * (t_s - BEGINS_S).max(0.0);
                needed.now_m = needed.now_m.max(now_m);
                needed.highest_m = needed.highest_m.max(over_m);
                if now_m > self.here.altitude_m {
                    needed.first_s = needed.first_s.min(t_s);
                }
            }
            at_m += way * dt_s;
            way = Vector2::new(cosine * way.x - sine * way.y, sine * way.x + cosine * way.y);
            t_s += dt_s;
        }
        needed
    }
}

/// How far the lowest point of a circle is above the ground, less the margin, m.
fn clearance_m(surface: &Surface<'_>, circle: &Escape, altitude_m: f64, margin_m: f64) -> f64 {
    let round_m = core::f64::consts::TAU * circle.radius_m;
    let steps = (round_m / CIRCLE_STEP_M).clamp(8.0, 200.0) as u32;
    let mut least_m = f64::INFINITY;
    for step in 0..steps {
        let angle = core::f64::consts::TAU * f64::from(step) / f64::from(steps);
        let at_m = circle.centre_m + Vector2::new(cos(angle), sin(angle)) * circle.radius_m;
        if let Some(ground_m) = surface.highest_m(at_m, CIRCLE_REACH_M) {
            least_m = least_m.min(altitude_m - ground_m - margin_m);
        }
    }
    least_m
}

impl TerrainWatch {
    /// Nothing is ahead.
    pub(super) const NONE: Self = Self {
        lowest_m: None,
        climbs_s: None,
        had_circle: None,
        is_in_the_way: false,
    };

    /// Whether a climb over the ground ahead is told.
    pub(in super::super) const fn climbs(&self) -> bool {
        self.climbs_s.is_some()
    }

    /// The lowest altitude above mean sea level that is flown to, m.
    pub(in super::super) const fn lowest_m(&self) -> Option<f64> {
        self.lowest_m
    }
}

impl Autopilot {
    /// Climbs over the ground ahead in time, or turns away from it.
    pub(super) fn keep_clear_of_terrain(&mut self, dt_s: f64) {
        let config = self.config.contingency;
        let terrain = self.config.terrain;
        let obstacles = self.config.plan.map_or(&[][..], |plan| plan.obstacles);
        let is_watched = !(terrain.is_empty() && obstacles.is_empty())
            && self.guidance.mode.mode() != Mode::Glide
            && config.terrain != ContingencyAction::Continue
            && self.guidance.runway().is_none()
            && !self.is_on_runway();
        let Some(mut here) = self.estimator.ground.here().copied().filter(|_| is_watched) else {
            self.supervisor.contingencies.terrain = TerrainWatch::default();
            return;
        };
        // The ground does not rise with the pressure: its height is compared with the lower
        // of what altimeter and receiver show.
        let below_m = self.estimator.ground.below_altimeter_m();
        here.altitude_m -= below_m;
        let speed_mps = length(here.ground_velocity_mps).max(1.0);
        let bank_rad = self.estimator.estimate().roll_rad;
        let is_level = bank_rad.abs() < LEVEL_RAD;
        let ahead_s = self.terrain_ahead_s(speed_mps);
        let within_m = speed_mps * ahead_s + CIRCLES_M;
        let surface = Surface::around(&here, &terrain, obstacles, within_m);
        let mut ahead = Ahead {
            surface: &surface,
            here: &here,
            course_rate_radps: if is_level {
                0.0
            } else {
                GRAVITY_MPS2 * tan(bank_rad) / speed_mps
            },
            ahead_s,
            margin_m: config.terrain_margin_m,
        };
        let climb_mps = self.config.envelope.max_climb_mps;
        let needed = ahead.needs(CLIMB_SHARE * climb_mps);
        let lowest_m = needed.now_m + below_m;
        self.supervisor.contingencies.terrain.lowest_m = Some(lowest_m).filter(|m| m.is_finite());
        self.tell_of_climb(dt_s);
        // A climb that is flown lags behind a little.
        ahead.margin_m *= LAG_SHARE;
        let most_mps = MOST_SHARE * climb_mps;
        let with_bank = ahead.needs(most_mps);
        let is_climbable = with_bank.now_m <= here.altitude_m;
        ahead.course_rate_radps = 0.0;
        let straight = ahead.needs(most_mps);
        let is_met = self.supervisor.contingencies.active == Contingency::Terrain;
        let stage = self.supervisor.contingencies.stage;
        let is_in_the_way = !is_climbable || straight.now_m > here.altitude_m;
        self.supervisor.contingencies.terrain.is_in_the_way = is_in_the_way;
        if !is_in_the_way {
            self.supervisor.contingencies.terrain.had_circle = None;
            let returns = config.terrain == ContingencyAction::Return && self.points_home(&here);
            if is_met && stage == Stage::TurningAway && returns {
                self.supervisor.contingencies.stage = Stage::Acting;
                self.return_home();
            }
            return;
        }
        if is_met && stage.is_on_circle() {
            return;
        }
        let first_s = with_bank.first_s.min(straight.first_s);
        let highest_m = with_bank.highest_m.max(straight.highest_m);
        self.turn_from_terrain(&surface, first_s, highest_m + below_m);
    }

    /// For how long the way ahead is looked at, s: on the leg of a plan, which was checked,
    /// to its end.
    fn terrain_ahead_s(&self, speed_mps: f64) -> f64 {
        let ahead_s = self.config.contingency.terrain_ahead_s;
        let of_plan = self
            .guidance
            .mode
            .over_ground()
            .filter(|mode| mode.mode() == Mode::Plan);
        of_plan.map_or(ahead_s, |mode| {
            ahead_s.min(mode.track().to_go_m.max(0.0) / speed_mps)
        })
    }

    /// Turns onto the better circle, when no other one is left or the ground is near, whose
    /// highest the altimeter shows at an altitude, m.
    fn turn_from_terrain(&mut self, surface: &Surface<'_>, first_s: f64, highest_m: f64) {
        let config = self.config.contingency;
        let here = self.at_its_speed(surface.here());
        let circles = Escape::both(&Fence::default(), &here, &self.fastest_bank());
        let Some(circles) = circles else {
            return;
        };
        let [left, right] = circles.map(|circle| {
            let margin_m = config.terrain_margin_m;
            let clear_m = clearance_m(surface, &circle, here.altitude_m, margin_m);
            (circle, clear_m)
        });
        let (circle, clear_m) = if right.1 >= left.1 { right } else { left };
        let watch = &mut self.supervisor.contingencies.terrain;
        if clear_m >= 0.0 {
            watch.had_circle = Some(circle.clockwise);
            return;
        }
        if watch.had_circle.is_none() && first_s > LAST_S {
            return;
        }
        // Neither is clear any more: of the last one the least is in the way.
        let circle = match watch.had_circle {
            Some(true) => right.0,
            Some(false) => left.0,
            None => circle,
        };
        let was_met = self.supervisor.contingencies.active == Contingency::Terrain;
        self.supervisor.contingencies.active = Contingency::Terrain;
        self.supervisor.contingencies.stage =
            if was_met || config.terrain == ContingencyAction::Loiter {
                Stage::Staying
            } else {
                Stage::TurningAway
            };
        // Faster, it would not hold it. On it, it climbs above what it turned away from.
        self.guidance.targets.airspeed_mps = self
            .guidance
            .targets
            .airspeed_mps
            .min(here.airspeed_mps + FASTER_MPS);
        self.guidance.targets.altitude_m = self
            .guidance
            .targets
            .altitude_m
            .max(highest_m + self.guidance.sea_level_m());
        self.circle(
            ModeInput::Pause,
            Some(here.plane_at(circle.centre_m)),
            circle.radius_m,
            circle.clockwise,
        );
        self.journal
            .add(notice(Contingency::Terrain, config.terrain));
    }

    /// Tells of a climb when it begins and when it is over.
    fn tell_of_climb(&mut self, dt_s: f64) {
        let sea_level_m = self.guidance.sea_level_m();
        let raised_m = self.guidance.demanded_altitude_m() - sea_level_m + RAISED_M;
        let watch = &mut self.supervisor.contingencies.terrain;
        let is_raised = watch.lowest_m.is_some_and(|lowest_m| lowest_m > raised_m);
        let said = match (watch.climbs_s, is_raised) {
            (None, true) => {
                watch.climbs_s = Some(0.0);
                Some(CLIMBS)
            }
            (Some(_), true) => {
                watch.climbs_s = Some(0.0);
                None
            }
            (Some(since_s), false) if since_s + dt_s >= OVER_S => {
                watch.climbs_s = None;
                Some(PASSED)
            }
            (Some(since_s), false) => {
                watch.climbs_s = Some(since_s + dt_s);
                None
            }
            (None, false) => None,
        };
        if let Some(item) = said {
            self.journal.add(Notice {
                kind: CONTINGENCY,
                amount_permille: Contingency::Terrain as u16 * PERMILLE,
                item,
                ..Notice::default()
            });
        }
    }
}
