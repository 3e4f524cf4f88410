//! The engine: out below a speed of its shaft, or, where that is not measured, if the
//! throttle gives no thrust. In flight the air turns a propeller, and no shaft stops from one
//! reading to the next: a speed that falls to nothing at once is that of a sensor that has
//! failed, and the thrust decides.

use core::time::Duration;

use libm::cos;

use super::super::Autopilot;
use super::{CONTINGENCY, Contingency, ContingencyAction, ContingencyConfig, Delayed, notice};
use fcc_core::blocks::LowPass;
use fcc_core::framework::{Notice, PERMILLE, Time};
use fcc_core::units::GRAVITY_MPS2;
use fcc_guidance::route::{Follower, GlideConfig, RunwayPhase, RunwayReason};
use fcc_guidance::{Mode, OverGroundMode};

/// A reading is used for so long.
const READING_AGE: Duration = Duration::from_secs(2);
/// With more throttle than this there is thrust.
const THROTTLE: f64 = 0.5;
/// Without thrust the path through the air, at constant airspeed, descends by at least this
/// share of the best glide: nothing glides better.
const SHARE: f64 = 0.6;
/// The power is averaged over this time, s: an engine that surges still gives some.
const POWER_S: f64 = 4.0;
/// What is taken for the power before it was averaged: level flight, and after an engine was
/// out a glide, sin γ.
const LEVEL: f64 = 0.0;
const GLIDE: f64 = -0.2;
/// A speed below this share of the one at which the engine is out is none.
const NO_SPEED: f64 = 0.1;
/// In a glide because of its thrust the engine is tried every so often, and for so long, s: the
/// throttle opens within 3 s, thrust follows within 2 s, and `engine_back_after_s` is 5 s.
const TRIED_EVERY_S: f64 = 45.0;
const TRIED_FOR_S: f64 = 14.0;
/// The amounts of the notices that it is over, and that its speed is not believed.
pub(super) const ENGINE_RUNS: u16 = Contingency::EngineOut as u16 * PERMILLE + 1;
pub(super) const SPEED_DOUBTED: u16 = ENGINE_RUNS + 1;
/// Lower than this an engine that runs again changes nothing, m.
const LANDS_M: f64 = 30.0;

/// What is known of the engine.
#[derive(Clone, Debug)]
pub(in super::super) struct Engine {
    out: Delayed,
    power: LowPass,
    /// Whether its speed is not believed.
    doubt: Delayed,
    /// The last measured speed, rad/s.
    before_radps: f64,
    /// In a glide the time since it was tried, s.
    glides_s: f64,
}

impl Engine {
    pub(in super::super) const fn new() -> Self {
        Self {
            out: Delayed::OFF,
            power: LowPass::new(POWER_S),
            doubt: Delayed::OFF,
            before_radps: 0.0,
            glides_s: 0.0,
        }
    }

    /// Whether the speed is not believed from now on: it fell to nothing at once.
    fn falls_to_nothing(&mut self, speed_radps: f64, below_radps: f64) -> bool {
        let ran = self.before_radps >= below_radps;
        self.before_radps = speed_radps;
        ran && speed_radps < NO_SPEED * below_radps && !self.out.is_on
    }

    /// Whether the throttle gives no thrust, by the power over weight and airspeed.
    fn gives_no_thrust(&mut self, power: f64, glide_ratio: f64, dt_s: f64) -> bool {
        self.power.step(power, dt_s) < -SHARE / glide_ratio
    }

    /// The throttle gives little in any case.
    fn is_throttled(&mut self) {
        self.power.reset(if self.out.is_on { GLIDE } else { LEVEL });
    }

    /// Whether the thrust tells of the engine.
    const fn is_watched_by_thrust(&self, config: &ContingencyConfig) -> bool {
        config.engine_by_thrust || self.doubt.is_on
    }

    /// Whether a glide opens the throttle, because the engine may give thrust again.
    pub(in super::super) fn opens(&mut self, config: &ContingencyConfig, dt_s: f64) -> bool {
        self.is_watched_by_thrust(config) && self.out.is_on && self.is_tried(dt_s)
    }

    /// Whether the engine is tried in a glide, after `dt_s` more of it.
    fn is_tried(&mut self, dt_s: f64) -> bool {
        self.glides_s = (self.glides_s + dt_s) % TRIED_EVERY_S;
        self.glides_s > TRIED_EVERY_S - TRIED_FOR_S
    }
}

/// The power over weight and airspeed at constant airspeed, (T - D)/W = sin γ + V̇/g (Lambregts
/// 1983); γ is the angle of the path through the air, so that rising and sinking air is none.
fn specific_power(path_rad: f64, acceleration_mps2: f64) -> f64 {
    libm::sin(path_rad) + acceleration_mps2 / GRAVITY_MPS2
}

impl Autopilot {
    /// Whether the engine is out by the speed of its shaft; none if it is not known.
    fn engine_stands(&mut self, now: Time, dt_s: f64) -> Option<bool> {
        let config = &self.config.contingency;
        let below_radps = config.engine_below_radps?;
        let speed_radps = self
            .intake
            .accepted
            .engine_speed_radps
            .fresh(now, READING_AGE)?;
        let airspeed_mps = self.estimator.estimate().airspeed_mps;
        let flies = airspeed_mps > self.config.envelope.stall_airspeed_mps && !self.is_on_wheels();
        if self
            .supervisor
            .engine
            .falls_to_nothing(speed_radps, below_radps)
            && flies
        {
            if !self.supervisor.engine.doubt.is_on {
                self.journal.add(Notice {
                    kind: CONTINGENCY,
                    amount_permille: SPEED_DOUBTED,
                    ..Notice::default()
                });
            }
            self.supervisor.engine.doubt.begin();
        }
        let stands = speed_radps < below_radps;
        let doubt = &mut self.supervisor.engine.doubt;
        if doubt.is_on {
            doubt.step(stands, config.engine_back_after_s, dt_s);
        }
        (!doubt.is_on).then_some(stands)
    }

    /// Whether the engine is out; none if it is not known.
    fn engine_is_out(&mut self, now: Time, dt_s: f64) -> Option<bool> {
        if let Some(stands) = self.engine_stands(now, dt_s) {
            return Some(stands);
        }
        let is_flown = self.guidance.mode.mode() != Mode::None && !self.is_on_runway();
        if !self
            .supervisor
            .engine
            .is_watched_by_thrust(&self.config.contingency)
            || !is_flown
            || self.loops.last.throttle < THROTTLE
        {
            self.supervisor.engine.is_throttled();
            return None;
        }
        let estimate = self.estimator.estimate();
        let path_rad = estimate.pitch_rad - estimate.angle_of_attack_rad * cos(estimate.roll_rad);
        let power = specific_power(path_rad, estimate.acceleration_mps2);
        let engine = &mut self.supervisor.engine;
        Some(engine.gives_no_thrust(power, self.config.contingency.glide_ratio, dt_s))
    }

    /// Follows the engine, engaged or not. Where nothing is known it stays what it was.
    pub(in super::super) fn follow_engine(&mut self, now: Time, dt_s: f64) {
        if let Some(is_out) = self.engine_is_out(now, dt_s) {
            let config = &self.config.contingency;
            let after_s = if is_out {
                config.engine_after_s
            } else {
                config.engine_back_after_s
            };
            self.supervisor.engine.out.step(is_out, after_s, dt_s);
        }
    }

    /// Acts on an engine that is out, once, and on one that runs again.
    pub(super) fn meet_engine_out(&mut self) {
        if !self.supervisor.engine.out.is_on {
            let glides = self.supervisor.contingencies.active == Contingency::EngineOut;
            if glides && self.supervisor.contingencies.is_engine_met {
                self.leave_glide();
            }
            self.supervisor.contingencies.is_engine_met = false;
            return;
        }
        if self.supervisor.contingencies.is_engine_met {
            return;
        }
        match self.guidance.runway().map(|demand| demand.phase) {
            Some(RunwayPhase::Roll) => return self.guidance.mode.go_around(RunwayReason::Engine),
            // It stands, and is about to roll.
            None if self.waits_for_takeoff() => return,
            Some(phase) if phase.is_on_wheels() || phase == RunwayPhase::Flare => return,
            _ => {}
        }
        self.supervisor.contingencies.is_engine_met = true;
        self.supervisor.engine.glides_s = 0.0;
        self.meet_engine(self.config.contingency.engine);
    }

    fn meet_engine(&mut self, action: ContingencyAction) {
        let amount_permille = Contingency::EngineOut as u16 * PERMILLE;
        self.begin_contingency(Contingency::EngineOut, action, amount_permille);
    }

    /// The engine runs again: a plan is continued; what else was flown is not known, and
    /// the aircraft circles. Low, and on the ground, the landing goes on.
    fn leave_glide(&mut self) {
        let is_low = self
            .guidance
            .runway()
            .is_some_and(|demand| demand.phase.is_on_wheels() || demand.height_m < LANDS_M);
        if is_low {
            return;
        }
        let glided = self.guidance.mode.mode() == Mode::Glide;
        self.supervisor.contingencies.end();
        let action = if !glided || self.supervisor.left_plan.is_some() {
            ContingencyAction::Continue
        } else {
            ContingencyAction::Loiter
        };
        if glided {
            self.guidance.targets.altitude_m = self.estimator.estimate().altitude_m;
            let airspeed_mps = self.config.reference_airspeed_mps;
            self.guidance.targets.airspeed_mps =
                self.config.envelope.allowed_airspeed(airspeed_mps);
            match action {
                ContingencyAction::Continue => self.fly_plan(0),
                _ => self.pause(),
            }
        }
        self.journal.add(Notice {
            amount_permille: ENGINE_RUNS,
            ..notice(Contingency::EngineOut, action)
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
        self.enter(&OverGroundMode::new(
            Mode::Glide,
            follower,
            self.guidance.targets,
        ));
    }

    /// Glides on after a restart, until the engine runs.
    pub(in super::super) fn resume_glide(&mut self) {
        self.supervisor.engine.out.begin();
        self.supervisor.contingencies.is_engine_met = true;
        self.meet_engine(ContingencyAction::Glide);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_S: f64 = 0.025;
    const RATIO: f64 = 9.0;

    /// Whether it is seen in `seconds` of a power that depends on the time, s.
    fn is_seen(seconds: f64, power: impl Fn(f64) -> f64) -> bool {
        let mut engine = Engine::new();
        engine.is_throttled();
        let ticks = (seconds / TICK_S) as u32;
        for n in 0..ticks {
            let is_out = engine.gives_no_thrust(power(f64::from(n) * TICK_S), RATIO, TICK_S);
            engine.out.step(is_out, 2.0, TICK_S);
        }
        engine.out.is_on
    }

    /// A Cessna 172 at 100 kt: level with its cruise power; without, 8 to 1 by JSBSim's
    /// model, level and slowing down by 1.2 m/s² at first.
    #[test]
    fn thrust_is_missing_in_a_glide_and_while_slowing_down() {
        let seen = |path_rad, mps2| is_seen(20.0, |_| specific_power(path_rad, mps2));
        assert!(!seen(0.0, 0.0));
        assert!(seen(-0.124, 0.0));
        assert!(seen(0.0, -1.2));
        // A descent of 3° with power, in which the airspeed is constant.
        assert!(!seen(-0.052, 0.0));
        // A dive that gains airspeed.
        assert!(!seen(-0.15, 1.0));
    }

    /// Thrust of a tenth for 3 s and of all for 3 s: half of the time it is a glide.
    #[test]
    fn an_engine_that_surges_is_not_out() {
        let power = |time_s: f64| if time_s % 6.0 < 3.0 { -0.12 } else { 0.02 };
        assert!(!is_seen(120.0, power));
    }

    #[test]
    fn in_a_glide_the_engine_is_tried_now_and_then() {
        let mut engine = Engine::new();
        let tried = (0..3_600).filter(|_| engine.is_tried(TICK_S)).count();
        // In 90 s.
        assert!((1_110..=1_130).contains(&tried), "{tried}");
    }
}
