//! Flies a route: one step after the other, with the turns between them.

use libm::{atan, atan2, tan};
use nalgebra::Vector2;

use super::back::TookOff;
use super::circle::Circling;
use super::corner::{Conditions, Corner};
use super::glide::GlideFlight;
use super::goal::{Goal, GoalKind, Next, Profile, Speed};
use super::leg::Leg;
use super::runway::RunwayFlight;
use super::sequence::{Sequence, Steps};
use super::step::{Destination, Route, Step, Until};
use super::{OverGround, PLANNED_SHARE, ROLL_LAG_S, RouteConfig};
use crate::path::{LocalPlane, Motion, Npfg, Path, length};

/// Flies a route.
///
/// Copied it goes on as the one that it was copied from, to the last bit.
///
/// ```
/// use fcc_guidance::path::LocalPlane;
/// use fcc_guidance::route::{Follower, OverGround, RouteConfig, Step};
/// use nalgebra::Vector2;
///
/// // A place to the east, while the aircraft flies north: it accelerates to the right.
/// let step = Step::Waypoint {
///     at: LocalPlane::at(0.8, 0.11),
///     altitude_m: 900.0,
///     within_m: f64::INFINITY,
/// };
/// let mut follower = Follower::to(step, &[], RouteConfig::default(), 50.0);
/// let here = OverGround {
///     latitude_rad: 0.8,
///     longitude_rad: 0.1,
///     altitude_m: 800.0,
///     ground_velocity_mps: Vector2::new(50.0, 0.0),
///     true_airspeed_mps: 50.0,
///     airspeed_mps: 48.0,
///     ..OverGround::default()
/// };
/// follower.advance(&here, 0.025);
/// assert!(follower.acceleration_mps2() > 1.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Follower {
    pub(super) config: RouteConfig,
    pub(super) sequence: Sequence,
    pub(super) returns: &'static [Destination],
    law: Npfg,
    /// The index of the step that is flown.
    pub(super) index: usize,
    pub(super) goal: Goal,
    /// Where the next leg leads, in the goal's plane.
    pub(super) next: Option<Next>,
    pub(super) phase: Phase,
    /// From where the altitude changes along the leg.
    pub(super) profile: Profile,
    pub(super) speed: Speed,
    pub(super) altitude_m: f64,
    airspeed_mps: f64,
    acceleration_mps2: f64,
    pub(super) track: Track,
    reached: Option<u16>,
    /// How far from its altitude, m.
    reached_off_m: f64,
    /// Landings that were given up, but for a command.
    pub(super) given_up: u8,
    /// Where the last take-off began.
    pub(super) took_off: Option<TookOff>,
    /// Of the last landing: where, and how far above its elevation the ground was that the
    /// range finder showed, m.
    pub(super) ground_above_m: Option<(LocalPlane, f64)>,
}

/// How the aircraft flies its path, for observers.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Track {
    /// True course of the path at its nearest point, rad, -π to π.
    pub course_rad: f64,
    /// How far the aircraft is to the right of the path, m.
    pub cross_track_m: f64,
    /// How far it is to the leg's end, a turn's item or a circle's centre, m.
    pub to_go_m: f64,
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Phase {
    /// To begin with the step of this index.
    Begin(usize),
    Leg(Leg),
    First(Leg, Corner),
    Second(Corner),
    Circle(Circling),
    Runway(RunwayFlight),
    Glide(GlideFlight),
}

impl Follower {
    /// Of a plan, from the step with an index on, with the airspeed until one is given,
    /// m/s.
    pub fn along(
        route: Route<'static>,
        index: usize,
        config: RouteConfig,
        airspeed_mps: f64,
    ) -> Self {
        let airspeed_mps = route.airspeed_mps.unwrap_or(airspeed_mps);
        Self::new(
            Steps::Plan(route),
            route.returns,
            index,
            config,
            airspeed_mps,
        )
    }

    /// One step, with an airspeed, m/s. A return leads to the nearest of `returns`.
    pub fn to(
        step: Step,
        returns: &'static [Destination],
        config: RouteConfig,
        airspeed_mps: f64,
    ) -> Self {
        Self::new(Steps::One(step), returns, 0, config, airspeed_mps)
    }

    pub(super) fn new(
        steps: Steps,
        returns: &'static [Destination],
        index: usize,
        config: RouteConfig,
        airspeed_mps: f64,
    ) -> Self {
        Self {
            config,
            sequence: Sequence::new(steps),
            returns,
            law: Npfg::new(config.law),
            index,
            goal: Goal {
                at: LocalPlane::at(0.0, 0.0),
                altitude_m: 0.0,
                kind: GoalKind::Place(f64::INFINITY),
            },
            next: None,
            phase: Phase::Begin(index),
            profile: Profile {
                to_go_m: 0.0,
                altitude_m: 0.0,
            },
            speed: Speed::Indicated(airspeed_mps),
            altitude_m: 0.0,
            airspeed_mps,
            acceleration_mps2: 0.0,
            track: Track::default(),
            reached: None,
            reached_off_m: 0.0,
            given_up: 0,
            took_off: None,
            ground_above_m: None,
        }
    }

    /// The index of the step that is flown.
    pub fn index(&self) -> usize {
        self.sequence.planned(self.index).0
    }

    /// Whether it has begun: altitude and acceleration mean something.
    pub const fn has_begun(&self) -> bool {
        !matches!(self.phase, Phase::Begin(_))
    }

    /// Whether a straight leg is flown, and no turn or circle.
    pub const fn is_on_leg(&self) -> bool {
        matches!(self.phase, Phase::Leg(_))
    }

    /// Whether it circles where its last step has led, and no step follows. A landing that
    /// was given up is not the end of a route.
    pub fn has_ended(&self) -> bool {
        let circles = matches!(
            (&self.phase, &self.goal.kind),
            (Phase::Circle(_), GoalKind::Circle(circle)) if circle.until == Until::Never
        );
        circles && !self.has_no_more_landings() && self.sequence.peek(self.index + 1).is_none()
    }

    /// The acceleration to the right of the air velocity that is demanded, m/s².
    pub const fn acceleration_mps2(&self) -> f64 {
        self.acceleration_mps2
    }

    /// The altitude that is demanded, m above mean sea level.
    pub const fn altitude_m(&self) -> f64 {
        self.altitude_m
    }

    /// The indicated airspeed that is demanded, m/s.
    pub const fn airspeed_mps(&self) -> f64 {
        self.airspeed_mps
    }

    /// How the path is flown.
    pub const fn track(&self) -> Track {
        self.track
    }

    /// The index of the step whose end was reached by the last
    /// [`advance`](Self::advance).
    pub const fn reached(&self) -> Option<u16> {
        self.reached
    }

    /// How far from its altitude the aircraft was there, m; 0 at the end of a take-off
    /// or a landing.
    pub const fn reached_off_m(&self) -> f64 {
        self.reached_off_m
    }

    /// `dt_s` seconds pass, with the aircraft here. With 0 nothing changes.
    pub fn advance(&mut self, here: &OverGround, dt_s: f64) {
        if let Some((_, above_m)) = &mut self.ground_above_m {
            *above_m += here.stepped_m;
        }
        self.reached = None;
        if !(here.is_finite() && dt_s > 0.0) {
            return;
        }
        if let Phase::Begin(index) = self.phase {
            self.altitude_m = here.altitude_m;
            self.goal.at = here.plane();
            self.goal.altitude_m = here.altitude_m;
            self.begin(index, &here.plane(), here);
        }
        if let Phase::Glide(flight) = self.phase {
            self.glide_on(flight, here, dt_s);
        }
        let mut motion = here.motion_in(&self.goal.at);
        if self.goes_on(here, &motion, dt_s) {
            motion = here.motion_in(&self.goal.at);
        }
        let path = self.path();
        self.acceleration_mps2 = self.law.acceleration_mps2(&path, &motion);
        let nearest = path.nearest(motion.position_m);
        self.track = Track {
            course_rad: atan2(nearest.course.y, nearest.course.x),
            cross_track_m: nearest.cross_track_m,
            to_go_m: match &self.phase {
                Phase::Leg(leg) => leg.left_m(motion.position_m),
                Phase::Runway(flight) => flight.left_m(&motion),
                _ => length(motion.position_m),
            },
        };
        self.follow_altitude(&motion);
        self.airspeed_mps = match (&self.phase, self.speed) {
            (Phase::Runway(flight), _) => flight.airspeed_mps(),
            (Phase::Glide(flight), _) => flight.airspeed_mps(),
            (_, Speed::Indicated(mps)) => mps,
            (_, Speed::OverGround(mps)) => {
                let through = nearest.course * mps - motion.wind_mps;
                length(through) * here.airspeed_mps / here.true_airspeed_mps.max(1.0)
            }
        };
    }

    fn path(&self) -> Path {
        match (&self.phase, &self.goal.kind) {
            (Phase::Leg(leg), _) => leg.path(),
            (Phase::First(_, corner), _) => corner.first().path(),
            (Phase::Second(corner), _) => corner.second().unwrap_or(corner.first()).path(),
            (Phase::Runway(flight), _) => flight.path(),
            (Phase::Glide(flight), _) => flight.path(),
            (_, GoalKind::Circle(circle)) => circle.path(),
            // Before it has begun.
            (_, GoalKind::Place(_) | GoalKind::Landing(_)) => Path::Line {
                through_m: Vector2::zeros(),
                course: Vector2::new(1.0, 0.0),
            },
        }
    }

    /// What follows in this tick; whether another step is flown.
    fn goes_on(&mut self, here: &OverGround, motion: &Motion, dt_s: f64) -> bool {
        let at_m = motion.position_m;
        self.wait(dt_s, length(at_m));
        let ahead_m = self.ahead_m(motion);
        let off_m = here.altitude_m - self.goal.altitude_m;
        match (self.phase, self.goal.kind) {
            (Phase::Leg(leg), GoalKind::Place(within_m)) => {
                let to_go_m = leg.left_m(at_m);
                let corner = self.corner(&leg, motion, within_m);
                match corner {
                    Some(corner) if to_go_m <= corner.lead_m + ahead_m => {
                        self.reach(off_m);
                        self.phase = Phase::First(leg, corner);
                    }
                    None if to_go_m <= 0.0 => {
                        self.reach(off_m);
                        return self.go_on(&self.goal.at.clone(), here);
                    }
                    _ => {}
                }
            }
            (Phase::Leg(leg), GoalKind::Circle(_)) => {
                if leg.left_m(at_m) <= ahead_m {
                    self.phase = Phase::Circle(Circling::default());
                }
            }
            (Phase::First(_, corner), _) => match corner.second() {
                // From one side to the other.
                Some(_) if corner.first().ends_within(2.0 * ahead_m, at_m) => {
                    self.phase = Phase::Second(corner);
                }
                None if corner.first().ends_within(ahead_m, at_m) => {
                    return self.go_on(&self.goal.at.clone(), here);
                }
                _ => {}
            },
            (Phase::Second(corner), _) => {
                let arc = corner.second().unwrap_or(corner.first());
                if arc.ends_within(ahead_m, at_m) {
                    return self.go_on(&self.goal.at.clone(), here);
                }
            }
            (Phase::Circle(mut circling), GoalKind::Circle(circle)) => {
                circling.follow(&circle, at_m, dt_s);
                self.phase = Phase::Circle(circling);
                let next_m = self.next.map(|next| next.place_m);
                if circle.is_over(&circling, off_m, at_m, next_m, ahead_m) {
                    self.reach(off_m);
                    return self.go_on(&here.plane(), here);
                }
            }
            (Phase::Runway(flight), _) => return self.step_runway(flight, here, motion, dt_s),
            (Phase::Begin(_) | Phase::Leg(_) | Phase::Circle(_) | Phase::Glide(_), _) => {}
        }
        false
    }

    /// The bank that turns are planned with, rad.
    fn planned_bank_rad(&self) -> f64 {
        atan(PLANNED_SHARE * tan(self.config.bank_rad))
    }

    /// How far before an arc its bank is commanded, m: a ramp is half of itself late.
    fn ahead_m(&self, motion: &Motion) -> f64 {
        let ramp_s = self.planned_bank_rad() / self.config.bank_rate_radps;
        length(motion.ground_velocity_mps) * (0.5 * ramp_s + ROLL_LAG_S)
    }

    /// The turn onto the next leg.
    fn corner(&self, leg: &Leg, motion: &Motion, within_m: f64) -> Option<Corner> {
        let next = self.next?.leg?;
        Corner::new(
            leg.course,
            next.course,
            &Conditions {
                airspeed_mps: length(motion.air_velocity_mps()),
                wind_mps: motion.wind_mps,
                bank_rad: self.planned_bank_rad(),
                room_m: leg.length_m.min(next.length_m),
                within_m,
            },
        )
    }

    /// The step's end is reached, so far from its altitude, m.
    pub(super) fn reach(&mut self, off_m: f64) {
        self.reached_off_m = off_m;
        let (index, is_end) = self.sequence.planned(self.index);
        self.reached = u16::try_from(index).ok().filter(|_| is_end);
    }
}
