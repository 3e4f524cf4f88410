//! The altitude and the airspeed that a route demands.

use super::follower::{Follower, Phase};
use super::goal::{Profile, Speed};
use super::step::Step;
use crate::path::Motion;

/// So near an altitude changes no more along a leg, m.
const LEAST_LEG_M: f64 = 1.0;

impl Follower {
    /// A step takes effect.
    pub(super) fn take(&mut self, step: &Step) {
        match *step {
            Step::Airspeed(mps) => self.speed = Speed::Indicated(mps),
            Step::GroundSpeed(mps) => self.speed = Speed::OverGround(mps),
            Step::Altitude(altitude_m) => {
                self.altitude_m = altitude_m;
                self.profile = Profile {
                    to_go_m: self.track.to_go_m,
                    altitude_m,
                };
            }
            _ => {}
        }
    }

    pub(super) fn wait(&mut self, dt_s: f64, to_go_m: f64) {
        let mut sequence = self.sequence;
        sequence.wait(dt_s, to_go_m, &mut |step| self.take(step));
        self.sequence = sequence;
    }

    /// Along a leg the altitude changes in proportion to the way.
    pub(super) fn follow_altitude(&mut self, motion: &Motion) {
        let goal_m = self.goal.altitude_m;
        self.altitude_m = match &self.phase {
            // The arc to the waypoint is still on the way to its altitude.
            Phase::Leg(leg) | Phase::First(leg, _) if self.profile.to_go_m > LEAST_LEG_M => {
                let share = leg.left_m(motion.position_m) / self.profile.to_go_m;
                goal_m + (self.profile.altitude_m - goal_m) * share.clamp(0.0, 1.0)
            }
            Phase::Runway(flight) if flight.phase.is_climb() => flight.altitude_m,
            Phase::Runway(flight) => flight.path_altitude_m(motion),
            Phase::Begin(_) => self.altitude_m,
            _ => goal_m,
        };
    }
}
