//! The engine: out below a speed of its shaft, or, where that is not measured, if the
//! throttle gives no thrust.

use core::time::Duration;

use libm::cos;

use super::super::Autopilot;
use super::{Contingency, ContingencyAction, PERMILLE};
use crate::flight::guidance::{Mode, OverGroundMode};
use crate::flight::route::{Follower, GlideConfig, RunwayPhase, RunwayReason};
use crate::framework::{Notice, Time};
use crate::units::GRAVITY_MPS2;

/// A reading is used for so long.
const READING_AGE: Duration = Duration::from_secs(2);
/// With more throttle than this there is thrust.
const THROTTLE: f64 = 0.5;
/// Without thrust the path through the air, at constant airspeed, descends by at least this
/// share of the best glide: nothing glides better.
const SHARE: f64 = 0.6;
/// Lower than this an engine that runs again changes nothing, m.
const LANDS_M: f64 = 30.0;

/// Whether the path of constant airspeed, (T - D)/W = sin γ + V̇/g (Lambregts 1983), is that
/// of an aircraft without thrust; γ is the angle of the path through the air, so that rising
/// and sinking air is none.
fn is_without_thrust(path_rad: f64, acceleration_mps2: f64, glide_ratio: f64) -> bool {
    libm::sin(path_rad) + acceleration_mps2 / GRAVITY_MPS2 < -SHARE / glide_ratio
}

impl Autopilot {
    /// Whether the engine is out; none if it is not known.
    fn engine_is_out(&self, now: Time) -> Option<bool> {
        let config = &self.config.contingency;
        let speed_radps = self.accepted.engine_speed_radps.fresh(now, READING_AGE);
        if let (Some(below_radps), Some(speed_radps)) = (config.engine_below_radps, speed_radps) {
            return Some(speed_radps < below_radps);
        }
        let is_flown = self.guidance.mode() != Mode::None && !self.is_on_runway();
        if !config.engine_by_thrust || !is_flown || self.last.throttle < THROTTLE {
            return None;
        }
        let estimate = self.navigation.estimate();
        let path_rad = estimate.pitch_rad - estimate.angle_of_attack_rad * cos(estimate.roll_rad);
        let acceleration_mps2 = estimate.acceleration_mps2;
        Some(is_without_thrust(
            path_rad,
            acceleration_mps2,
            config.glide_ratio,
        ))
    }

    /// Follows the engine, engaged or not. Where nothing is known it stays what it was.
    pub(in super::super) fn follow_engine(&mut self, now: Time, dt_s: f64) {
        if let Some(is_out) = self.engine_is_out(now) {
            let config = &self.config.contingency;
            let after_s = if is_out {
                config.engine_after_s
            } else {
                config.engine_back_after_s
            };
            self.engine.step(is_out, after_s, dt_s);
        }
    }

    /// Acts on an engine that is out, once, and on one that runs again.
    pub(super) fn meet_engine_out(&mut self) {
        if !self.engine.is_on {
            let glides = self.contingencies.active == Contingency::EngineOut;
            if glides && self.contingencies.is_engine_met {
                self.leave_glide();
            }
            self.contingencies.is_engine_met = false;
            return;
        }
        if self.contingencies.is_engine_met {
            return;
        }
        match self.runway().map(|demand| demand.phase) {
            Some(RunwayPhase::Roll) => return self.guidance.go_around(RunwayReason::Engine),
            // It stands, and is about to roll.
            None if self.waits_for_takeoff() => return,
            Some(phase) if phase.is_on_wheels() || phase == RunwayPhase::Flare => return,
            _ => {}
        }
        self.contingencies.is_engine_met = true;
        self.begin_contingency(Contingency::EngineOut, self.config.contingency.engine);
    }

    /// The engine runs again: a plan is continued; what else was flown is not known, and
    /// the aircraft circles. Low, and on the ground, the landing goes on.
    fn leave_glide(&mut self) {
        let is_low = self
            .runway()
            .is_some_and(|demand| demand.phase.is_on_wheels() || demand.height_m < LANDS_M);
        if is_low {
            return;
        }
        let glided = self.guidance.mode() == Mode::Glide;
        self.contingencies.end();
        let action = if !glided || self.left_plan.is_some() {
            ContingencyAction::Continue
        } else {
            ContingencyAction::Loiter
        };
        if glided {
            self.targets.altitude_m = self.navigation.estimate().altitude_m;
            let airspeed_mps = self.config.reference_airspeed_mps;
            self.targets.airspeed_mps = self.config.envelope.allowed_airspeed(airspeed_mps);
            match action {
                ContingencyAction::Continue => self.fly_plan(0),
                _ => self.pause(),
            }
        }
        self.contingencies.announce(Contingency::EngineOut, action);
        // That it is over.
        self.contingencies.news = self.contingencies.news.map(|notice| Notice {
            amount_permille: Contingency::EngineOut as u16 * PERMILLE + 1,
            ..notice
        });
    }

    /// Glides to the best place that is reached.
    pub(in super::super) fn glide(&mut self) {
        let config = &self.config;
        let glide = GlideConfig {
            airspeed_mps: config.envelope.best_glide_airspeed_mps,
            ratio: config.contingency.glide_ratio,
            spare_m: config.contingency.glide_spare_m,
        };
        let follower = Follower::gliding(config.plan.unwrap_or_default(), config.route, glide);
        self.enter(&OverGroundMode::new(Mode::Glide, follower, self.targets));
    }

    /// Glides on after a restart, until the engine runs.
    pub(in super::super) fn resume_glide(&mut self) {
        self.engine.begin();
        self.contingencies.is_engine_met = true;
        self.begin_contingency(Contingency::EngineOut, ContingencyAction::Glide);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Cessna 172 at 100 kt: level with its cruise power; without, 8 to 1 by JSBSim's
    /// model, level and slowing down by 1.2 m/s² at first.
    #[test]
    fn thrust_is_missing_in_a_glide_and_while_slowing_down() {
        assert!(!is_without_thrust(0.0, 0.0, 9.0));
        assert!(is_without_thrust(-0.124, 0.0, 9.0));
        assert!(is_without_thrust(0.0, -1.2, 9.0));
        // A descent of 3° with power, in which the airspeed is constant.
        assert!(!is_without_thrust(-0.052, 0.0, 9.0));
        // A dive that gains airspeed.
        assert!(!is_without_thrust(-0.15, 1.0, 9.0));
    }
}
