//! The controls during take-off and landing.
//!
//! | phase | lateral | vertical | throttle, brakes |
//! |---|---|---|---|
//! | Hand | neutral | neutral | idle |
//! | Roll, Rotate | nose wheel and rudder along the centre line, wings level | elevator neutral, then pitch | full |
//! | Climb, `GoAround` | bank onto the centre line | pitch, less below the climb's airspeed | full |
//! | Approach | bank onto the centre line | climb rate of the glide path | airspeed |
//! | Flare | rudder to the runway's heading, bank against the drift | sink rate by height | closing; by the altitude, airspeed |
//! | `RollOut`, Stopped | as in the roll | elevator back, but not in a tail wind | idle, brakes |
//!
//! Without power the approach is that of the [glide](super::gliding).

mod begins;
mod climbing;
mod gear;
mod in_failsafe;
mod notices;
mod on_wheels;

use libm::atan;

use super::Autopilot;
use crate::control::{Lateral, ThrottleDemand};
use fcc_core::blocks::{limit, limit_abs, wrap_pi};
use fcc_core::flight::Surfaces;
use fcc_core::units::GRAVITY_MPS2;
use fcc_guidance::OverGroundMode;
use fcc_guidance::route::{HELD_MPS, RunwayDemand, RunwayPhase, RunwayReason};
use fcc_navigation::Estimate;
pub(super) use in_failsafe::Low;
pub(super) use notices::{RUNWAY, notice, write};
pub use notices::{gives_up_runway, touches_ground};

/// Rudder per heading error, 1/rad, per its integral, 1/(rad s), and per yaw rate, s, at
/// the reference airspeed.
const RUDDER_PER_RAD: f64 = 1.6;
const RUDDER_PER_RAD_S: f64 = 0.8;
const RUDDER_PER_RADPS: f64 = 1.2;
/// Limit of the integral, and its time constant on the wheels, s.
const MOST_INTEGRAL: f64 = 0.7;
const FORGETS_S: f64 = 3.0;
/// Bank of the flare: acceleration per metre off the centre line, 1/s², per drift, 1/s;
/// at most, rad (6°: a low wing stays off the ground).
const DRIFT_PER_S2: f64 = 0.16;
const DRIFT_PER_S: f64 = 0.8;
const MOST_FLARE_BANK_RAD: f64 = 0.105;
/// Lower than this the bank of a climb is at most that of the flare, m.
const LOW_M: f64 = 15.0;
/// The nose is aligned with the runway below this height, m.
const ALIGNS_M: f64 = 2.0;
/// The throttle is opened so fast in a go-around, 1/s.
const OPENS_PER_S: f64 = 1.0;
/// And after a throw: it has to fly before it is down.
const THROWN_OPENS_PER_S: f64 = 2.0;
/// How fast the throttle is closed in the flare, 1/s.
pub(super) const CLOSES_PER_S: f64 = 0.35;
/// A glide tries the engine above this height, m: below, what it would give is too late.
const TRIES_ABOVE_M: f64 = 100.0;
/// The elevator is held back below this share of the approach's airspeed.
const HELD_BACK_BELOW: f64 = 0.7;
/// Without an airspeed it may have so much more through the air than over the ground, m/s
/// (25 kt): an elevator held back in a head wind lifted it off.
const UNKNOWN_HEAD_WIND_MPS: f64 = 12.861;
/// An approach speed is so many times the stalling speed.
pub(super) const OVER_STALL: f64 = 1.3;
/// The lowest airspeed of approach and climb, of the commanded one.
pub(super) const LOWEST_SHARE: f64 = 0.88;

/// What the controls of a runway remember.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RunwayControl {
    phase: Option<RunwayPhase>,
    /// Integrated rudder.
    rudder: f64,
    brake: f64,
    /// The airspeed with which it flies, m/s, as the measured one is wrong.
    pub(super) flies_at_mps: Option<f64>,
    /// It was told that the climb lasts too long.
    lacks_power: bool,
    /// It was told that the landing has much tail wind.
    told_wind: bool,
    /// The roll-out has left the centre line with its brakes set.
    strayed: bool,
}

impl Autopilot {
    /// Whether the wheels carry the aircraft, or it is about to touch down.
    pub(super) fn is_on_runway(&self) -> bool {
        let flares = |demand: RunwayDemand| demand.phase == RunwayPhase::Flare;
        self.is_on_wheels() || self.guidance.runway().is_some_and(flares)
    }

    /// Whether it stands or rolls.
    pub(super) fn is_on_wheels(&self) -> bool {
        let rolls = |demand: RunwayDemand| demand.phase.is_on_wheels();
        self.estimator.ground.stands_on_wheels() || self.guidance.runway().is_some_and(rolls)
    }

    /// Whether it stands on its wheels, or is held in a hand that throws it.
    pub(super) fn waits_for_takeoff(&self) -> bool {
        let is_held =
            self.config.route.runway.is_thrown() && self.estimator.ground.speed_mps() < HELD_MPS;
        self.estimator.ground.stands_on_wheels() || is_held
    }

    /// The outputs of a take-off or a landing; none while neither is flown.
    pub(super) fn control_on_runway(&mut self, estimate: &Estimate, dt_s: f64) -> Option<Surfaces> {
        let Some(demand) = self.guidance.runway() else {
            if self.guidance.on_runway.phase.is_some() {
                // The throttle was not the airspeed loop's.
                let last = self.loops.last;
                self.take_over(&last);
                self.loops
                    .heading
                    .lead_from(self.guidance.setpoints.roll_rad);
            }
            let mode = self.guidance.mode.over_ground();
            if self.guidance.on_runway.phase == Some(RunwayPhase::GoAround)
                && mode.is_some_and(OverGroundMode::has_no_more_landings)
            {
                self.journal.add(notice(RunwayReason::NoMore));
            }
            self.guidance.on_runway = RunwayControl::default();
            return None;
        };
        self.enter_phase(&demand, estimate);
        if demand.lacks_power && !self.guidance.on_runway.lacks_power {
            self.journal.add(notice(RunwayReason::NoClimb));
        }
        self.guidance.on_runway.lacks_power = demand.lacks_power;
        let approaches = demand.phase == RunwayPhase::Approach && !demand.is_powerless;
        if let Some(event) = self
            .guidance
            .on_runway
            .watch_tail_wind(approaches, demand.head_wind_mps)
        {
            self.journal.add(event);
        }
        let lateral = match demand.phase {
            RunwayPhase::Hand => Lateral::default(),
            phase if phase.is_on_wheels() => self.steer(&demand, estimate, dt_s),
            RunwayPhase::Flare => self.align(&demand, estimate, dt_s),
            _ => self.follow_centre_line(&demand, estimate, dt_s),
        };
        let (throttle, climb_rate_mps, pitch_rad, elevator) =
            self.vertical_on_runway(&demand, estimate, dt_s);
        self.guidance
            .show(lateral.roll_rad, climb_rate_mps, pitch_rad);
        let outputs = Surfaces {
            throttle,
            elevator,
            aileron: lateral.aileron,
            rudder: lateral.rudder,
            ..Surfaces::IDLE
        };
        Some(self.with_wheels(&demand, outputs, estimate, dt_s))
    }

    /// The loops take over at a phase's begin.
    fn enter_phase(&mut self, demand: &RunwayDemand, estimate: &Estimate) {
        let before = self.guidance.on_runway.phase.replace(demand.phase);
        if before == Some(demand.phase) {
            return;
        }
        if demand.reason != RunwayReason::None {
            self.journal.add(notice(demand.reason));
        }
        if demand.reason == RunwayReason::LongFlare {
            self.estimator.ground.expect_no_range();
        }
        if demand.reason == RunwayReason::RangeJump {
            self.estimator.ground.leave_range();
        }
        let (last, schedule) = (self.loops.last, self.schedule());
        match demand.phase {
            RunwayPhase::Rotate => self
                .loops
                .altitude
                .engage(last.elevator, estimate, schedule),
            RunwayPhase::Climb | RunwayPhase::Approach
                if before.is_some_and(RunwayPhase::is_on_wheels) =>
            {
                if demand.phase == RunwayPhase::Climb && before != Some(RunwayPhase::Rotate) {
                    // No pitch was held on the wheels.
                    self.loops
                        .altitude
                        .engage(last.elevator, estimate, schedule);
                }
                if demand.airspeed_is_wrong {
                    self.leave_airspeed(demand, estimate);
                }
                self.loops
                    .heading
                    .engage(last.aileron, last.rudder, estimate, schedule);
                self.loops.bank.reset(estimate.roll_rad);
            }
            RunwayPhase::Flare => {
                self.guidance.on_runway.rudder = last.rudder;
                if demand.is_powerless {
                    // The pitch was not that of a climb rate.
                    self.loops
                        .altitude
                        .engage(last.elevator, estimate, schedule);
                }
            }
            RunwayPhase::GoAround if before == Some(RunwayPhase::Flare) => {
                self.loops
                    .heading
                    .engage(last.aileron, last.rudder, estimate, schedule);
                self.loops.bank.reset(estimate.roll_rad);
            }
            _ => {}
        }
    }

    /// It flies with an airspeed with which it cannot: in calm air it would have that over
    /// the ground, and at least that of the rotation.
    fn leave_airspeed(&mut self, demand: &RunwayDemand, estimate: &Estimate) {
        let sqrt_density = estimate.airspeed_mps / estimate.true_airspeed_mps.max(1e-3);
        let calm_mps = demand.ground_speed_mps * limit(sqrt_density, 0.5, 1.1);
        self.guidance.on_runway.flies_at_mps =
            Some(calm_mps.max(self.config.route.runway.rotate_mps));
    }

    /// How far the heading is to the left of that of the runway, rad.
    fn off_heading_rad(&self, demand: &RunwayDemand) -> f64 {
        let heading_rad = self
            .estimator
            .ground
            .here()
            .map_or(0.0, |here| here.heading_rad);
        wrap_pi(demand.course_rad - heading_rad)
    }

    /// The rudder that turns the nose by an angle, rad.
    fn rudder_towards(&mut self, off_rad: f64, estimate: &Estimate, dt_s: f64) -> f64 {
        let moment = self.schedule().moment;
        // On the wheels it is forgotten: the nose wheel steers, too.
        let forgets = if self.estimator.ground.stands_on_wheels() {
            self.guidance.on_runway.rudder / FORGETS_S
        } else {
            0.0
        };
        let integral = &mut self.guidance.on_runway.rudder;
        let rate = moment * RUDDER_PER_RAD_S * off_rad - forgets;
        *integral = limit_abs(*integral + rate * dt_s, MOST_INTEGRAL);
        let yaw_radps = estimate.body_rates.yaw_radps;
        let rudder = moment * (RUDDER_PER_RAD * off_rad - RUDDER_PER_RADPS * yaw_radps);
        limit_abs(rudder + *integral, 1.0)
    }

    /// In the flare: the nose along the runway, and a bank against the drift.
    fn align(&mut self, demand: &RunwayDemand, estimate: &Estimate, dt_s: f64) -> Lateral {
        let schedule = self.schedule();
        let wanted_mps2 =
            -DRIFT_PER_S2 * demand.cross_track_m - DRIFT_PER_S * demand.cross_track_mps;
        // The side force of the slip accelerates it, too.
        let by_bank_mps2 = wanted_mps2 - estimate.side_force_mps2;
        let roll_rad = limit_abs(atan(by_bank_mps2 / GRAVITY_MPS2), MOST_FLARE_BANK_RAD);
        let roll_rad = self.loops.heading.led(roll_rad, dt_s);
        let held = self
            .loops
            .heading
            .hold_bank(roll_rad, estimate, schedule, dt_s);
        if demand.height_m > ALIGNS_M + demand.uncertainty_m {
            self.guidance.on_runway.rudder = held.rudder;
            return held;
        }
        let off_rad = self.off_heading_rad(demand);
        Lateral {
            rudder: self.rudder_towards(off_rad, estimate, dt_s),
            ..held
        }
    }

    /// In the air: onto the centre line by bank.
    fn follow_centre_line(
        &mut self,
        demand: &RunwayDemand,
        estimate: &Estimate,
        dt_s: f64,
    ) -> Lateral {
        let acceleration = self.guidance.mode.over_ground();
        let acceleration = acceleration.map_or(0.0, OverGroundMode::acceleration_mps2);
        let bank_rad = self.loops.bank.step(acceleration, dt_s);
        let bank_rad = if demand.height_m < LOW_M && demand.phase.is_climb() {
            limit_abs(bank_rad, MOST_FLARE_BANK_RAD)
        } else {
            bank_rad
        };
        let (envelope, schedule) = (self.runway_envelope(demand), self.schedule());
        self.loops
            .heading
            .bank_to(bank_rad, estimate, &envelope, schedule, dt_s)
    }

    /// Throttle, climb rate, pitch and elevator.
    fn vertical_on_runway(
        &mut self,
        demand: &RunwayDemand,
        estimate: &Estimate,
        dt_s: f64,
    ) -> (f64, f64, f64, f64) {
        let (envelope, schedule) = (self.runway_envelope(demand), self.schedule());
        let closing = (self.loops.last.throttle - CLOSES_PER_S * dt_s).max(0.0);
        let opens_per_s = if self.is_thrown(demand) {
            THROWN_OPENS_PER_S
        } else if demand.phase == RunwayPhase::GoAround {
            OPENS_PER_S
        } else {
            CLOSES_PER_S
        };
        let opening = (self.loops.last.throttle + opens_per_s * dt_s).min(1.0);
        match demand.phase {
            RunwayPhase::Hand => (0.0, 0.0, 0.0, 0.0),
            RunwayPhase::Roll => (opening, 0.0, 0.0, 0.0),
            RunwayPhase::RollOut | RunwayPhase::Stopped => {
                let fast_mps = HELD_BACK_BELOW * self.config.route.runway.approach_mps;
                // Whichever is more: an airspeed that is wrong raises no nose.
                let speed_mps = estimate.airspeed_mps.max(demand.ground_speed_mps);
                let head_mps = if demand.reason == RunwayReason::NoAirspeed {
                    UNKNOWN_HEAD_WIND_MPS
                } else {
                    0.0
                };
                let slow = limit(1.0 - (speed_mps + head_mps) / fast_mps, 0.0, 1.0);
                let along_mps = demand.ground_speed_mps + demand.head_wind_mps;
                (closing, 0.0, 0.0, on_wheels::elevator(slow, along_mps))
            }
            RunwayPhase::Approach if demand.is_powerless => {
                let vertical = self.hold_glide(&envelope, estimate, dt_s);
                let elevator = self.loops.actuation.elevator(vertical.elevator);
                let tries = demand.height_m > TRIES_ABOVE_M
                    && self.supervisor.engine.opens(&self.config.contingency, dt_s);
                (
                    if tries { opening } else { closing },
                    vertical.climb_rate_mps,
                    vertical.pitch_rad,
                    elevator,
                )
            }
            RunwayPhase::Approach | RunwayPhase::Flare => {
                let flares = demand.phase == RunwayPhase::Flare;
                let altitude = &mut self.loops.altitude;
                let vertical = altitude.hold_climb_rate(
                    demand.climb_rate_mps,
                    estimate,
                    &envelope,
                    if flares { schedule.brisk() } else { schedule },
                    dt_s,
                );
                let share = if flares { LOWEST_SHARE } else { 1.0 };
                let airspeed = ThrottleDemand {
                    airspeed_mps: envelope
                        .floor_mps(estimate)
                        .max(share * self.guidance.targets.airspeed_mps),
                    climb_rate_mps: vertical.climb_rate_mps,
                    load_factor: 1.0,
                    least_throttle: envelope.least_throttle(estimate.airspeed_mps),
                };
                let throttle = if flares && demand.uncertainty_m == 0.0 {
                    closing
                } else {
                    self.loops.airspeed.step(&airspeed, estimate, dt_s)
                };
                let elevator = self.loops.actuation.elevator(vertical.elevator);
                (
                    throttle,
                    vertical.climb_rate_mps,
                    vertical.pitch_rad,
                    elevator,
                )
            }
            RunwayPhase::Rotate | RunwayPhase::Climb | RunwayPhase::GoAround => {
                let pitch_rad = self.climb_pitch_rad(demand, estimate);
                let vertical = self
                    .loops
                    .altitude
                    .hold_pitch(pitch_rad, estimate, &envelope, schedule, dt_s);
                let elevator = self.loops.actuation.elevator(vertical.elevator);
                (
                    opening,
                    vertical.climb_rate_mps,
                    vertical.pitch_rad,
                    elevator,
                )
            }
        }
    }
}
