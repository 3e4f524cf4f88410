//! Modes and plan: where to be in each tick.

use core::f64::consts::{FRAC_PI_2, TAU};

use fcc_core::blocks::{wrap_pi, wrap_two_pi};
use fcc_core::units::GRAVITY_MPS2;
use libm::{atan2, cos, hypot, sin, sqrt, tan};
use nalgebra::Vector3;

use crate::estimator::State;
use crate::plan::{Item, Waypoint};
use crate::position::Reference;
use crate::trajectory::{Leg, SPEED_PER_S, Trajectory, corner};
use crate::values::{Command, Mode, Velocity};

/// The number of the notice that an item of the plan was reached.
pub const ITEM_REACHED: u8 = 1;
/// A place counts as reached if both the path and the vehicle are this near, m.
const REACHED_M: f64 = 0.3;
/// And it is as fast as the path up to this, m/s.
const SETTLED_MPS: f64 = 0.5;
/// From this distance on the path waits for the vehicle, and stops at the other one, m.
const WAITS_FROM_M: f64 = 0.5;
const STOPS_AT_M: f64 = 2.0;
/// The lowest take-off, m.
const LOWEST_M: f64 = 1.0;
/// Below this height above home it sinks slowly, m.
const SLOWLY_BELOW_M: f64 = 4.0;
/// Below this height it rises again if the wind tilts it by more than 25°, m: it would tip
/// over on the ground.
const WAITS_BELOW_M: f64 = 1.2;
const COS_TOUCHES: f64 = 0.906;
/// A stick that is not given again for so long is let go, s.
const LET_GO_AFTER_S: f64 = 2.0;
/// How fast the speed approaches that of a tilted stick, 1/s.
const TILT_PER_S: f64 = 0.5;
/// Shorter legs do not turn the nose, m.
const TURNS_FROM_M: f64 = 1.0;

/// What is not exceeded.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Limits {
    /// Over the ground, m/s.
    pub speed_mps: f64,
    /// Upwards, m/s.
    pub climb_mps: f64,
    /// Downwards, m/s.
    pub sink_mps: f64,
    /// At touchdown, m/s.
    pub touchdown_mps: f64,
    /// Of the path, m/s².
    pub acceleration_mps2: f64,
    /// Of the path, m/s³.
    pub jerk_mps3: f64,
    /// Of the thrust, rad.
    pub tilt_rad: f64,
    /// About roll and pitch, rad/s.
    pub rate_radps: f64,
    /// Of the nose, rad/s.
    pub yaw_rate_radps: f64,
    /// How far inside of a corner a waypoint is passed, m.
    pub rounding_m: f64,
    /// The lowest height of the way home, m.
    pub return_height_m: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            speed_mps: 6.0,
            climb_mps: 3.0,
            sink_mps: 1.5,
            touchdown_mps: 0.5,
            acceleration_mps2: 3.5,
            jerk_mps3: 25.0,
            tilt_rad: 45.0_f64.to_radians(),
            rate_radps: 220.0_f64.to_radians(),
            yaw_rate_radps: 60.0_f64.to_radians(),
            rounding_m: 0.5,
            return_height_m: 15.0,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Activity {
    Idle,
    TakeOff,
    /// For so long, s.
    Hover(f64),
    GoTo,
    Circle(Circle),
    /// Above the place where it began, and then home.
    Return(HomeLeg),
    Land,
    Descend,
    Stick(Stick),
}

#[derive(Clone, Copy, PartialEq, Debug)]
struct Stick {
    wanted: Velocity,
    /// How fast the speed over the ground approaches it, 1/s.
    follows_per_s: f64,
    age_s: f64,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum HomeLeg {
    Climb,
    Home,
}

#[derive(Clone, Copy, PartialEq, Debug)]
struct Circle {
    centre_m: Vector3<f64>,
    /// Negative: counter-clockwise.
    radius_m: f64,
    /// Of the place, seen from the centre, clockwise from north.
    angle_rad: f64,
    speed_mps: f64,
    left_rad: f64,
}

/// Where to be.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Guidance {
    limits: Limits,
    plan: &'static [Item],
    /// Of the plan, from 1; 0 if none is flown.
    item: usize,
    activity: Activity,
    leg: Leg,
    /// Before the end of the leg the next one begins, m.
    passes_m: f64,
    path: Trajectory,
    heading_rad: f64,
    wanted_heading_rad: f64,
    /// An item that was reached in this tick.
    reached: Option<usize>,
}

impl Guidance {
    pub(crate) fn new(limits: Limits, plan: &'static [Item]) -> Self {
        Self {
            limits,
            plan,
            item: 0,
            activity: Activity::Idle,
            leg: Leg::default(),
            passes_m: 0.0,
            path: Trajectory::default(),
            heading_rad: 0.0,
            wanted_heading_rad: 0.0,
            reached: None,
        }
    }

    pub(crate) const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// What is flown, and the item of the plan.
    pub(crate) fn mode(&self) -> (Mode, u16) {
        let mode = match self.activity {
            Activity::Idle => Mode::Idle,
            Activity::TakeOff => Mode::TakeOff,
            Activity::Hover(_) => Mode::Hover,
            Activity::GoTo if self.item > 0 => Mode::Plan,
            Activity::GoTo => Mode::GoTo,
            Activity::Circle(_) => Mode::Circle,
            Activity::Return(_) => Mode::Return,
            Activity::Land => Mode::Land,
            Activity::Descend => Mode::Descend,
            Activity::Stick(_) => Mode::Stick,
        };
        (mode, self.item as u16)
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.activity == Activity::Idle
    }

    /// Whether it sinks to the ground.
    pub(crate) fn descends(&self) -> bool {
        matches!(self.activity, Activity::Land | Activity::Descend)
    }

    /// An item that was reached in this tick, from 1.
    pub(crate) const fn reached(&self) -> Option<usize> {
        self.reached
    }

    /// Begins where it is: on the ground with the plan, in the air by holding its place.
    pub(crate) fn engage(&mut self, state: &State, flies: bool) {
        let (_, _, heading_rad) = state.attitude.euler_angles();
        self.heading_rad = wrap_two_pi(heading_rad);
        self.wanted_heading_rad = self.heading_rad;
        self.path = Trajectory {
            position_m: state.position_m,
            velocity_mps: if flies {
                state.velocity_mps
            } else {
                Vector3::zeros()
            },
            ..Trajectory::default()
        };
        self.stop();
        self.leg = Leg::default();
        if flies {
            self.hold(f64::INFINITY);
        } else {
            self.fly_item(1);
        }
    }

    /// The motors are off.
    pub(crate) fn stop(&mut self) {
        self.activity = Activity::Idle;
        self.item = 0;
    }

    /// Lands where it is; without a position it only sinks.
    pub(crate) fn land(&mut self, has_position: bool) {
        if self.is_idle() {
            return;
        }
        if !self.descends() {
            self.stop_here();
        }
        self.activity = if has_position {
            Activity::Land
        } else {
            Activity::Descend
        };
    }

    pub(crate) fn command(&mut self, command: &Command) {
        if let Command::TakeOff(height_m) = *command
            && self.is_idle()
        {
            self.item = 0;
            self.begin(&Item::TakeOff(height_m));
        } else if let Command::Plan(item) = *command {
            let item = usize::from(item.max(1));
            let takes_off = |item: &Item| matches!(item, Item::TakeOff(_));
            let from = self.plan.get(item - 1);
            if from.is_some_and(|item| takes_off(item) == self.is_idle()) {
                self.fly_item(item);
            }
        } else if !self.is_idle() {
            let item = match *command {
                Command::Hover => Item::Hover(f64::INFINITY),
                Command::GoTo(to) => Item::Waypoint(Waypoint {
                    place_m: Vector3::new(to.north_m, to.east_m, -to.height_m.max(LOWEST_M)),
                    heading_rad: to.heading_rad.or(Some(self.wanted_heading_rad)),
                    stops: true,
                }),
                Command::Circle(radius_m) => Item::Circle {
                    radius_m,
                    turns: f64::INFINITY,
                },
                Command::Return => Item::Return,
                Command::Land => Item::Land,
                Command::StopMotors => return self.stop(),
                Command::Move(wanted) => return self.take_stick(wanted, SPEED_PER_S),
                Command::Tilt(tilt) => {
                    let speed = |rad: f64| GRAVITY_MPS2 * tan(rad) / TILT_PER_S;
                    let wanted = Velocity {
                        forward_mps: -speed(tilt.pitch_rad),
                        right_mps: speed(tilt.roll_rad),
                        climb_mps: tilt.climb_mps,
                        yaw_radps: tilt.yaw_radps,
                    };
                    return self.take_stick(wanted, TILT_PER_S);
                }
                Command::TakeOff(_) | Command::Plan(_) => return,
            };
            self.item = 0;
            self.begin(&item);
        }
    }

    fn take_stick(&mut self, wanted: Velocity, follows_per_s: f64) {
        self.item = 0;
        self.leg = Leg::default();
        self.activity = Activity::Stick(Stick {
            wanted,
            follows_per_s,
            age_s: 0.0,
        });
    }

    fn fly_item(&mut self, item: usize) {
        let plan = self.plan;
        if let Some(next) = item.checked_sub(1).and_then(|index| plan.get(index)) {
            self.item = item;
            self.begin(next);
        } else if self.item > 0 {
            self.item = 0;
            self.hold(f64::INFINITY);
        }
    }

    fn begin(&mut self, item: &Item) {
        self.passes_m = 0.0;
        match *item {
            Item::TakeOff(height_m) => {
                let to_m = Vector3::new(
                    self.path.position_m.x,
                    self.path.position_m.y,
                    -height_m.max(LOWEST_M),
                );
                self.leg_to(to_m);
                self.activity = Activity::TakeOff;
            }
            Item::Waypoint(waypoint) => self.fly_to(&waypoint),
            Item::Hover(seconds) => self.hold(seconds),
            Item::Circle { radius_m, turns } => {
                let to_centre_rad = self.heading_rad + FRAC_PI_2;
                let offset = Vector3::new(cos(to_centre_rad), sin(to_centre_rad), 0.0) * radius_m;
                let behind = if radius_m > 0.0 {
                    FRAC_PI_2
                } else {
                    -FRAC_PI_2
                };
                let ahead = Vector3::new(cos(self.heading_rad), sin(self.heading_rad), 0.0);
                self.activity = Activity::Circle(Circle {
                    centre_m: self.path.position_m + offset,
                    radius_m,
                    angle_rad: self.heading_rad - behind,
                    speed_mps: self.path.velocity_mps.dot(&ahead).max(0.0),
                    left_rad: TAU * turns,
                });
            }
            Item::Return => {
                let mut above_m = self.path.position_m;
                above_m.z = above_m.z.min(-self.limits.return_height_m);
                self.leg_to(above_m);
                self.activity = Activity::Return(HomeLeg::Climb);
            }
            Item::Land => self.land(true),
        }
    }

    /// Holds the place where it can stop.
    fn hold(&mut self, seconds: f64) {
        self.stop_here();
        self.activity = Activity::Hover(seconds);
    }

    fn stop_here(&mut self) {
        let (place_m, velocity) = (self.path.position_m, self.path.velocity_mps);
        let way_m = velocity * (velocity.norm() / self.limits.acceleration_mps2);
        let arrives = self.leg.exit_mps <= 0.0 && (self.leg.to_m - place_m).norm() < REACHED_M;
        self.leg_to(if arrives {
            self.leg.to_m
        } else {
            place_m + way_m
        });
        self.leg.from_m = self.leg.to_m;
        self.wanted_heading_rad = self.heading_rad;
    }

    /// A leg from where the last one ends, if it is passed, or from the path's place.
    fn leg_to(&mut self, to_m: Vector3<f64>) {
        let from_m = if self.leg.exit_mps > 0.0 {
            self.leg.to_m
        } else {
            self.path.position_m
        };
        self.leg = Leg {
            from_m,
            to_m,
            speed_mps: 0.0,
            exit_mps: 0.0,
        };
        let direction = self.leg.direction();
        let limits = &self.limits;
        let vertical_mps = if direction.z < 0.0 {
            limits.climb_mps
        } else {
            limits.sink_mps
        };
        let level = hypot(direction.x, direction.y).max(1e-6);
        let speed_mps = limits.speed_mps / level;
        self.leg.speed_mps = speed_mps.min(vertical_mps / direction.z.abs().max(1e-6));
    }

    fn fly_to(&mut self, waypoint: &Waypoint) {
        self.leg_to(waypoint.place_m);
        self.activity = Activity::GoTo;
        let way = self.leg.to_m - self.leg.from_m;
        if let Some(heading_rad) = waypoint.heading_rad {
            self.wanted_heading_rad = wrap_two_pi(heading_rad);
        } else if hypot(way.x, way.y) > TURNS_FROM_M {
            self.wanted_heading_rad = wrap_two_pi(atan2(way.y, way.x));
        }
        let next = self.plan.get(self.item).filter(|_| self.item > 0);
        if let Some(Item::Waypoint(next)) = next
            && !waypoint.stops
            && let Some(after) = (next.place_m - waypoint.place_m).try_normalize(1e-3)
        {
            let before = self.leg.direction();
            let limits = &self.limits;
            let (exit_mps, passes_m) = corner(
                &before,
                &after,
                limits.rounding_m,
                limits.acceleration_mps2,
                self.leg.speed_mps,
            );
            self.leg.exit_mps = exit_mps;
            // The shorter leg is not all corner.
            let shorter_m = way.norm().min((next.place_m - waypoint.place_m).norm());
            self.passes_m = passes_m.min(0.4 * shorter_m);
        }
    }

    /// Advances by a tick; none on the ground. `has_landed` ends a landing.
    pub(crate) fn step(&mut self, state: &State, has_landed: bool, dt_s: f64) -> Option<Reference> {
        self.reached = None;
        let off_m = (self.path.position_m - state.position_m).norm();
        let off_mps = (self.path.velocity_mps - state.velocity_mps).norm();
        // Time on the path runs slower while the vehicle cannot follow it.
        let pace = ((STOPS_AT_M - off_m) / (STOPS_AT_M - WAITS_FROM_M)).clamp(0.05, 1.0);
        let pace = if self.descends() { 1.0 } else { pace };
        let path_s = pace * dt_s;
        match self.activity {
            Activity::Idle => return None,
            Activity::Land | Activity::Descend if has_landed => {
                self.reached = (self.item > 0).then_some(self.item);
                self.stop();
                return None;
            }
            Activity::Land | Activity::Descend => self.sink(state, dt_s),
            Activity::Circle(circle) => self.circle(circle, path_s),
            Activity::Stick(stick) => self.steer(stick, state, dt_s),
            Activity::Hover(left_s) => {
                self.follow(path_s);
                self.activity = Activity::Hover(left_s - dt_s);
                if left_s <= 0.0 {
                    self.end_item();
                }
            }
            Activity::TakeOff | Activity::GoTo | Activity::Return(_) => {
                let left_m = self.follow(path_s);
                let ahead_m = (self.leg.to_m - self.path.position_m).dot(&self.leg.direction());
                let is_passed = self.leg.exit_mps > 0.0 && ahead_m <= self.passes_m;
                let is_there = left_m.max(off_m) < REACHED_M && off_mps < SETTLED_MPS;
                if is_passed || is_there {
                    self.reach();
                }
            }
        }
        Some(self.reference(pace, dt_s))
    }

    fn reach(&mut self) {
        match self.activity {
            Activity::Return(HomeLeg::Climb) => {
                self.leg_to(Vector3::new(0.0, 0.0, self.leg.to_m.z));
                self.activity = Activity::Return(HomeLeg::Home);
            }
            Activity::Return(HomeLeg::Home) => self.activity = Activity::Land,
            _ => self.end_item(),
        }
    }

    /// The item is flown, or the command.
    fn end_item(&mut self) {
        if self.item > 0 {
            self.reached = Some(self.item);
            self.fly_item(self.item + 1);
        } else {
            self.activity = Activity::Hover(f64::INFINITY);
        }
    }

    fn follow(&mut self, dt_s: f64) -> f64 {
        let limits = &self.limits;
        let (most, jerk) = (limits.acceleration_mps2, limits.jerk_mps3);
        self.path.follow(&self.leg, most, jerk, dt_s)
    }

    fn sink(&mut self, state: &State, dt_s: f64) {
        let limits = &self.limits;
        // From the height at which it has to brake.
        let is_low = -state.position_m.z < SLOWLY_BELOW_M;
        let waits = -state.position_m.z < WAITS_BELOW_M && state.cos_tilt() < COS_TOUCHES;
        let sink_mps = if waits && self.activity == Activity::Land {
            -limits.touchdown_mps
        } else if is_low || self.activity == Activity::Descend {
            limits.touchdown_mps
        } else {
            limits.sink_mps
        };
        if self.activity == Activity::Descend {
            // Without a position, the velocity of the accelerometer is brought to nothing.
            self.path.position_m = state.position_m;
            self.leg.to_m = state.position_m;
        }
        let (most, jerk) = (limits.acceleration_mps2, limits.jerk_mps3);
        let level = Vector3::new(1.0, 1.0, 0.0);
        let off_m = (self.leg.to_m - self.path.position_m).component_mul(&level);
        let down = Vector3::new(0.0, 0.0, sink_mps);
        self.path.accelerate(&down, &off_m, most, jerk, dt_s);
    }

    fn steer(&mut self, mut stick: Stick, state: &State, dt_s: f64) {
        let limits = &self.limits;
        let wanted = &stick.wanted;
        let (ahead, aside) = (wanted.forward_mps, wanted.right_mps);
        let (sin, cos) = (sin(self.heading_rad), cos(self.heading_rad));
        let level = Vector3::new(cos * ahead - sin * aside, sin * ahead + cos * aside, 0.0);
        let level = level.cap_magnitude(limits.speed_mps);
        if stick.follows_per_s < SPEED_PER_S {
            // The tilt is the stick's: no error of place or speed adds to it.
            let (place_m, speed_mps) = (&state.position_m, &state.velocity_mps);
            (self.path.position_m.x, self.path.position_m.y) = (place_m.x, place_m.y);
            (self.path.velocity_mps.x, self.path.velocity_mps.y) = (speed_mps.x, speed_mps.y);
        }
        let path = Vector3::new(self.path.velocity_mps.x, self.path.velocity_mps.y, 0.0);
        let mut to_mps = path + (level - path) * (stick.follows_per_s / SPEED_PER_S);
        // Brakes above the lowest height, by 1 m/s for each metre.
        let sinks_mps = (-state.position_m.z - LOWEST_M).clamp(0.0, limits.sink_mps);
        to_mps.z = -wanted.climb_mps.clamp(-sinks_mps, limits.climb_mps);
        let most_radps = limits.yaw_rate_radps;
        let yaw_radps = wanted.yaw_radps.clamp(-most_radps, most_radps);
        self.wanted_heading_rad = wrap_two_pi(self.heading_rad + yaw_radps * dt_s);
        let (most, jerk) = (limits.acceleration_mps2, limits.jerk_mps3);
        let none = Vector3::zeros();
        self.path.accelerate(&to_mps, &none, most, jerk, dt_s);
        stick.age_s += dt_s;
        self.activity = Activity::Stick(stick);
        if stick.age_s > LET_GO_AFTER_S {
            self.hold(f64::INFINITY);
        }
    }

    fn circle(&mut self, mut circle: Circle, dt_s: f64) {
        let limits = &self.limits;
        let radius_m = circle.radius_m.abs();
        // Half of the acceleration turns, a third of it speeds up and brakes.
        let (turns_mps2, speeds_mps2) = (0.5, 0.33);
        let most = limits.acceleration_mps2;
        let cruise = sqrt(turns_mps2 * most * radius_m).min(limits.speed_mps);
        let stops = sqrt(2.0 * speeds_mps2 * most * (circle.left_rad * radius_m).max(0.0));
        let change = cruise.min(stops) - circle.speed_mps;
        let change = change.clamp(-speeds_mps2 * most * dt_s, speeds_mps2 * most * dt_s);
        circle.speed_mps += change;
        let sense = if circle.radius_m < 0.0 { -1.0 } else { 1.0 };
        circle.left_rad -= circle.speed_mps * dt_s / radius_m;
        circle.angle_rad += sense * circle.speed_mps * dt_s / radius_m;
        let outwards = Vector3::new(cos(circle.angle_rad), sin(circle.angle_rad), 0.0);
        let course_rad = circle.angle_rad + sense * FRAC_PI_2;
        let ahead = Vector3::new(cos(course_rad), sin(course_rad), 0.0);
        self.path = Trajectory {
            position_m: circle.centre_m + outwards * radius_m,
            velocity_mps: ahead * circle.speed_mps,
            acceleration_mps2: ahead * (change / dt_s.max(1e-6))
                - outwards * (circle.speed_mps * circle.speed_mps / radius_m),
        };
        self.wanted_heading_rad = wrap_two_pi(course_rad);
        self.leg = Leg::default();
        self.activity = Activity::Circle(circle);
        if circle.left_rad <= 0.0 || (circle.left_rad < 0.01 && circle.speed_mps < 0.1) {
            self.stop_here();
            self.end_item();
        }
    }

    fn reference(&mut self, pace: f64, dt_s: f64) -> Reference {
        let most_rad = self.limits.yaw_rate_radps * dt_s;
        let turn_rad =
            wrap_pi(self.wanted_heading_rad - self.heading_rad).clamp(-most_rad, most_rad);
        self.heading_rad = wrap_two_pi(self.heading_rad + turn_rad);
        Reference {
            position_m: self.path.position_m,
            velocity_mps: self.path.velocity_mps * pace,
            acceleration_mps2: self.path.acceleration_mps2 * (pace * pace),
            heading_rad: self.heading_rad,
            heading_rate_radps: turn_rad / dt_s.max(1e-6),
            descends: self.descends(),
        }
    }
}
