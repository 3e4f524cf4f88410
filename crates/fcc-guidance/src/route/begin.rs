//! How a step of a route begins: where it leads, and the leg to there.

use nalgebra::Vector2;

use super::circle::{Circle, Circling};
use super::follower::{Follower, Phase};
use super::goal::{Goal, GoalKind, Next, Profile};
use super::leg::Leg;
use super::runway::{Runway, RunwayFlight};
use super::step::{Step, Until, nearest_of};
use super::{OverGround, RETURNS_CLOCKWISE};
use crate::path::{LocalPlane, Motion, cross, length};

/// Whether the aircraft flies along the leg of a landing, or stands behind its begin.
fn is_on_approach(leg: &Leg, here: &OverGround, motion: &Motion) -> bool {
    /// So far off the centre line, m, and that much more for each metre to go.
    const OFF_M: f64 = 100.0;
    const OFF_SHARE: f64 = 0.15;
    /// The cosine of 30°.
    const ALONG: f64 = 0.866;
    let (to_go_m, velocity) = (leg.left_m(motion.position_m), motion.ground_velocity_mps);
    let off_m = cross(leg.course, motion.position_m).abs();
    here.on_wheels == Some(true)
        || to_go_m > 0.0
            && off_m < OFF_M + OFF_SHARE * to_go_m
            && leg.course.dot(&velocity) > ALONG * length(velocity)
}

impl Follower {
    /// Goes on with the next step from a place.
    pub(super) fn go_on(&mut self, from: &LocalPlane, here: &OverGround) -> bool {
        self.begin(self.index + 1, from, here);
        true
    }

    /// Begins the first step that is flown from an index on, with a leg from a place.
    pub(super) fn begin(&mut self, index: usize, from: &LocalPlane, here: &OverGround) {
        let mut sequence = self.sequence;
        let mut found = sequence.next(index, &mut |step| self.take(step));
        if let Some((index, Step::LandBack { height_m })) = found
            && let Some(took_off) = self.took_off
        {
            let steps = took_off.landing(height_m, &self.config);
            found = Some((index, sequence.land_back(index, &steps)));
        }
        self.sequence = sequence;
        self.next = None;
        if let Some((index, step)) = found {
            self.index = index;
            if let Step::Takeoff {
                runway,
                altitude_m,
                pitch_rad,
            } = step
            {
                let config = self.config.runway;
                let flight = RunwayFlight::takeoff(runway, here, config, altitude_m, pitch_rad);
                self.took_off = flight.took_off().or(self.took_off);
                self.goal.at = flight.runway.at;
                self.goal.altitude_m = altitude_m;
                self.phase = Phase::Runway(flight);
                return;
            }
            self.goal = self.goal_of(&step, here);
            self.next = self.next_after(index);
        } else {
            // Around the last place.
            self.goal.kind = GoalKind::Circle(match self.goal.kind {
                GoalKind::Circle(circle) => Circle {
                    until: Until::Never,
                    ..circle
                },
                GoalKind::Place(_) | GoalKind::Landing(_) => self.usual_circle(),
            });
        }
        let begin_m = self.goal.at.origin_of_m(from);
        self.phase = match self.goal.kind {
            GoalKind::Place(_) => {
                let motion = here.motion_in(&self.goal.at);
                // Where it is no way, straight on over it.
                Leg::to_place(begin_m, Vector2::zeros())
                    .or_else(|| {
                        let back_m = -motion.ground_velocity_mps;
                        Leg::to_place(back_m, Vector2::zeros())
                    })
                    .map_or(self.phase, Phase::Leg)
            }
            GoalKind::Landing(abort_altitude_m) => {
                let motion = here.motion_in(&self.goal.at);
                let before = self.sequence.approach_from(self.index);
                let begin_m = before.map_or(begin_m, |before| self.goal.at.origin_of_m(&before));
                let leg = Leg::to_place(begin_m, Vector2::zeros());
                // From elsewhere, the landing is begun as it is planned.
                if leg.is_some_and(|leg| !is_on_approach(&leg, here, &motion))
                    && let Some(before) = self.sequence.before_landing(self.index)
                {
                    self.begin(before, &here.plane(), here);
                    return;
                }
                leg.map_or(self.phase, |leg| {
                    let runway = Runway {
                        at: self.goal.at,
                        course: leg.course,
                        elevation_m: self.goal.altitude_m,
                    };
                    let config = self.config.runway;
                    let before = self.ground_above_m.filter(|(at, _)| *at == runway.at);
                    let flight =
                        RunwayFlight::landing(runway, here, &motion, config, abort_altitude_m);
                    Phase::Runway(flight.over_ground_above(before.map(|(_, above_m)| above_m)))
                })
            }
            GoalKind::Circle(circle) => {
                let (radius_m, clockwise) = (circle.radius_m, circle.clockwise);
                Leg::to_circle(begin_m, Vector2::zeros(), radius_m, clockwise)
                    .map_or(Phase::Circle(Circling::default()), Phase::Leg)
            }
        };
        if let Phase::Leg(leg) = self.phase {
            let motion = here.motion_in(&self.goal.at);
            self.profile = Profile {
                to_go_m: leg.left_m(motion.position_m),
                altitude_m: self.altitude_m,
            };
        }
    }

    /// Circles over where it leads, at an altitude, m above mean sea level.
    pub(super) fn circle_over(&mut self, altitude_m: f64) {
        self.goal.altitude_m = altitude_m;
        self.goal.kind = GoalKind::Circle(self.usual_circle());
        self.next = None;
        self.phase = Phase::Circle(Circling::default());
    }

    fn usual_circle(&self) -> Circle {
        Circle {
            radius_m: self.config.loiter_radius_m,
            clockwise: RETURNS_CLOCKWISE,
            until: Until::Never,
            leave_towards_next: false,
        }
    }

    fn goal_of(&self, step: &Step, here: &OverGround) -> Goal {
        match *step {
            Step::Waypoint {
                at,
                altitude_m,
                within_m,
            } => Goal {
                at,
                altitude_m,
                kind: GoalKind::Place(within_m),
            },
            Step::Land {
                at,
                elevation_m,
                abort_altitude_m,
            } => Goal {
                at,
                altitude_m: elevation_m,
                kind: GoalKind::Landing(abort_altitude_m),
            },
            Step::Loiter {
                at,
                altitude_m,
                radius_m,
                clockwise,
                until,
                leave_towards_next,
            } => Goal {
                at: at.unwrap_or_else(|| here.beside(if clockwise { radius_m } else { -radius_m })),
                altitude_m,
                kind: GoalKind::Circle(Circle {
                    radius_m,
                    clockwise,
                    until,
                    leave_towards_next,
                }),
            },
            _ => {
                let nearest = nearest_of(self.returns, here);
                let radius_m = self.config.loiter_radius_m;
                let altitude_m = nearest.map_or(here.altitude_m, |place| {
                    place.altitude_m.max(here.altitude_m)
                });
                Goal {
                    at: nearest.map_or_else(|| here.beside(radius_m), |place| place.at),
                    altitude_m,
                    kind: GoalKind::Circle(self.usual_circle()),
                }
            }
        }
    }

    fn next_after(&self, index: usize) -> Option<Next> {
        let (at, circle) = match self.sequence.peek(index + 1)? {
            Step::Waypoint { at, .. } | Step::Land { at, .. } => (at, None),
            Step::Loiter {
                at: Some(at),
                radius_m,
                clockwise,
                ..
            } => (at, Some((radius_m, clockwise))),
            _ => return None,
        };
        let place_m = self.goal.at.origin_of_m(&at);
        let leg = match circle {
            None => Leg::to_place(Vector2::zeros(), place_m),
            Some((radius_m, clockwise)) => {
                Leg::to_circle(Vector2::zeros(), place_m, radius_m, clockwise)
            }
        };
        Some(Next { place_m, leg })
    }
}
