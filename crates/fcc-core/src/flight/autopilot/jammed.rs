//! Ailerons or an elevator that do not move the aircraft: it is flown by what is left.

use core::fmt;

use super::degraded::flown_otherwise;
use super::degraded::otherwise::{
    AILERONS, ELEVATOR, REVERSED_AILERONS, REVERSED_BOTH, REVERSED_ELEVATOR, RUDDER,
};
use super::reversed::Reversed;
use super::{Autopilot, flags};
use crate::blocks::LowPass;
use crate::flight::Surfaces;
use crate::flight::control::{
    BankByRudder, ClimbByThrottle, ReversedRudder, Schedule, SurfaceEffect, SurfaceResponse,
    is_jammed,
};
use crate::flight::navigation::Estimate;
use crate::framework::{Flags, Notice};
use crate::units::GRAVITY_MPS2;

/// The most bank then, rad (15°): a rudder rolls slowly, and without an elevator a turn
/// lowers the nose.
const MOST_BANK_RAD: f64 = 0.262;
/// Rudder and throttle of the latest seconds are those from which both begin, s.
const USUAL_S: f64 = 20.0;
/// Slower than this times the stalling speed nothing is judged: a wing that stalls does not
/// answer, either.
pub(super) const LEAST_STALL_RATIO: f64 = 1.15;

/// Nothing is judged for so long after the engagement, a recovery, a stall or a contact with the
/// ground, s: trims are found anew, and wheels that bounce hold the pitch.
const SETTLED_S: f64 = 20.0;
/// With a surface that does not move the aircraft the bank is off by this, rad (6°), or the
/// pitch, rad (4°), for this time, s: what is sluggish follows.
pub(super) const BANK_OFF_RAD: f64 = 0.105;
pub(super) const PITCH_OFF_RAD: f64 = 0.07;
const OFF_S: f64 = 0.5;

/// A reversed rudder shows within this time after the ailerons seemed to be jammed by it, s.
/// Later it banks in their place, and its effect is not told from theirs.
const ANOTHER_WITHIN_S: f64 = 5.0;

/// What does not move the aircraft.
#[derive(Clone, Debug)]
pub(super) struct Jammed {
    ailerons: SurfaceResponse,
    aileron_effect: SurfaceEffect,
    elevator: SurfaceResponse,
    /// For how long the aircraft has flown so that it may be judged, s.
    judged_s: f64,
    bank_off_s: f64,
    pitch_off_s: f64,
    /// Where the elevator's trim stood.
    trim: Option<f64>,
    rudder: LowPass,
    throttle: LowPass,
    /// The trims of ailerons and elevator before they were found to be jammed.
    aileron_trim: Option<f64>,
    elevator_trim: Option<f64>,
    /// What moves the aircraft the wrong way is flown without, too.
    pub(super) reversed: Reversed,
    by_rudder: BankByRudder,
    by_throttle: ClimbByThrottle,
    reversed_rudder: ReversedRudder,
    /// Where the rudder stays.
    rudder_stays: Option<f64>,
    /// For how long ailerons or elevator have not been used, s.
    left_s: f64,
}

impl Jammed {
    pub(super) fn new() -> Self {
        Self {
            ailerons: SurfaceResponse::new(),
            aileron_effect: SurfaceEffect::new(),
            elevator: SurfaceResponse::new(),
            judged_s: 0.0,
            bank_off_s: 0.0,
            pitch_off_s: 0.0,
            trim: None,
            rudder: LowPass::new(USUAL_S),
            throttle: LowPass::new(USUAL_S),
            aileron_trim: None,
            elevator_trim: None,
            reversed: Reversed::new(),
            by_rudder: BankByRudder::default(),
            by_throttle: ClimbByThrottle::default(),
            reversed_rudder: ReversedRudder::new(),
            rudder_stays: None,
            left_s: 0.0,
        }
    }

    /// Whether the ailerons or the elevator do not move the aircraft.
    pub(super) const fn is_any(&self) -> bool {
        self.aileron_trim.is_some() || self.elevator_trim.is_some()
    }

    /// Whether any surface is not used as usual.
    const fn has_left_one(&self) -> bool {
        self.is_any() || self.rudder_stays.is_some()
    }

    /// Flies without surfaces that stay where they are given, since the aircraft was trimmed
    /// with `standing`.
    pub(super) const fn flies_without(
        &mut self,
        aileron: Option<f64>,
        elevator: Option<f64>,
        standing: &Surfaces,
    ) {
        (self.aileron_trim, self.elevator_trim) = (aileron, elevator);
        self.rudder.reset(standing.rudder);
        self.throttle.reset(standing.throttle);
    }

    pub(super) const fn is_elevator(&self) -> bool {
        self.elevator_trim.is_some()
    }

    /// The largest bank, rad, of those that are permitted.
    pub(super) const fn most_bank_rad(&self, permitted_rad: f64) -> f64 {
        if self.is_any() {
            permitted_rad.min(MOST_BANK_RAD)
        } else {
            permitted_rad
        }
    }

    /// What is summed up begins anew: the aircraft is not flown by its surfaces alone.
    fn forget_responses(&mut self) {
        self.ailerons = SurfaceResponse::new();
        self.elevator = SurfaceResponse::new();
        self.reversed_rudder = ReversedRudder::new();
    }
}

/// Writes the notice of an item; `None` if it is another one.
pub(super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> Option<fmt::Result> {
    let text = match notice.item {
        AILERONS => {
            "the ailerons do not move the aircraft: banking by the rudder, 15° at most, until \
             the release"
        }
        ELEVATOR => {
            "the elevator does not move the aircraft: climbing and descending by the throttle, \
             at the airspeed it is trimmed for, until the release"
        }
        RUDDER => {
            "the rudder turns the aircraft the other way: it stays where it was, until the release"
        }
        REVERSED_AILERONS => {
            "the ailerons move the aircraft the wrong way: check the servo's direction; they stay \
             centred, banking by the rudder, 15° at most, until the release"
        }
        REVERSED_ELEVATOR => {
            "the elevator moves the aircraft the wrong way: check the servo's direction; it stays \
             centred, climbing and descending by the throttle, until the release"
        }
        REVERSED_BOTH => {
            "ailerons and elevator move the aircraft the wrong way, or are exchanged: check the \
             servos' directions and outputs; both stay centred, flying by rudder and throttle \
             until the release"
        }
        _ => return None,
    };
    Some(f.write_str(text))
}

impl Autopilot {
    /// The rates that are expected of a full aileron and elevator, rad/s.
    pub(super) fn expected_radps(&self, estimate: &Estimate, schedule: Schedule) -> [f64; 2] {
        let roll = 1.0 / (schedule.rate * self.config.heading.aileron_per_roll_rate).max(1e-3);
        // The load of a unit of elevator turns the path by g/V for each g.
        let per_g = (schedule.moment * self.config.altitude.elevator_per_g).max(1e-3);
        let pitch = GRAVITY_MPS2 / estimate.true_airspeed_mps.max(1.0) / per_g;
        [roll, pitch]
    }

    /// Compares what ailerons and elevator were commanded with how the aircraft moves.
    pub(super) fn watch_surfaces(&mut self, estimate: &Estimate, schedule: Schedule, dt_s: f64) {
        let stall_mps = self.config.envelope.stall_airspeed_mps;
        let says_nothing = !self.config.finds_jammed_controls
            || self.is_on_runway()
            || self.recovery.is_active()
            || self.is_not_followed()
            || !self.actuation.conditions().is_empty()
            || estimate.airspeed_mps < LEAST_STALL_RATIO * stall_mps;
        let is_unsettled = self.recovery.is_active() || self.is_on_runway();
        let jammed = &mut self.jammed;
        if says_nothing {
            jammed.forget_responses();
            if is_unsettled {
                jammed.judged_s = 0.0;
            }
            return;
        }
        let excess_radps = estimate.yaw_excess_radps();
        let causes = [estimate.side_force_mps2, self.last.aileron];
        let rudder = &mut jammed.reversed_rudder;
        let is_reversed = rudder.step(self.last.rudder, excess_radps, causes, dt_s);
        jammed.left_s += if jammed.is_any() { dt_s } else { 0.0 };
        if is_reversed && jammed.rudder_stays.is_none() && jammed.left_s < ANOTHER_WITHIN_S {
            jammed.rudder_stays = Some(jammed.rudder.output());
            // Ailerons that it acted against seemed to be jammed.
            if !jammed.reversed.is_aileron() {
                jammed.aileron_trim = None;
            }
            self.news = Some(flown_otherwise(RUDDER));
        }
        jammed.judged_s += dt_s;
        if jammed.judged_s < SETTLED_S {
            return;
        }
        // Flown by what is left, the other one is commanded otherwise than usual.
        if jammed.has_left_one() {
            return;
        }
        let full_radps = self.expected_radps(estimate, schedule);
        let jammed = &mut self.jammed;
        let (sent, rates, gusts) = (&self.last, estimate.body_rates, estimate.gust_load);
        jammed.rudder.step(sent.rudder, dt_s);
        jammed.throttle.step(sent.throttle, dt_s);
        let [roll, pitch] = full_radps;
        // While the trim moves, it takes the place of the elevator.
        if jammed.trim != sent.elevator_trim {
            jammed.trim = sent.elevator_trim;
            jammed.elevator = SurfaceResponse::new();
        }
        let (p_radps, q_radps) = (rates.roll_radps, rates.pitch_radps);
        let ailerons = &mut jammed.ailerons;
        let elevator = &mut jammed.elevator;
        let unanswered = ailerons.step(sent.aileron, roll, p_radps, gusts, dt_s);
        let effect = &mut jammed.aileron_effect;
        let effect_per_s = effect.step(sent.aileron * roll, p_radps, [0.0; 2], dt_s);
        let lasts = |off_rad: f64, s: f64, most_rad| {
            if off_rad.abs() > most_rad {
                s + dt_s
            } else {
                0.0
            }
        };
        let bank_rad = self.setpoints.roll_rad - estimate.roll_rad;
        let pitch_rad = self.setpoints.pitch_rad - estimate.pitch_rad;
        jammed.bank_off_s = lasts(bank_rad, jammed.bank_off_s, BANK_OFF_RAD);
        jammed.pitch_off_s = lasts(pitch_rad, jammed.pitch_off_s, PITCH_OFF_RAD);
        let unanswered_pitch = elevator.step(sent.elevator, pitch, q_radps, gusts, dt_s);
        let is_rudder = jammed.reversed_rudder.seems();
        if jammed.bank_off_s > OFF_S && !is_rudder && is_jammed(unanswered, effect_per_s) {
            jammed.aileron_trim = Some(ailerons.trim());
            self.news = Some(flown_otherwise(AILERONS));
        } else if jammed.pitch_off_s > OFF_S && unanswered_pitch > 1.0 {
            jammed.elevator_trim = Some(elevator.trim());
            self.news = Some(flown_otherwise(ELEVATOR));
        }
    }

    /// The outputs with what takes the place of a jammed surface. The surface is commanded as
    /// if it worked, but without an integral: it may be free again.
    pub(super) fn around_jammed(
        &mut self,
        outputs: Surfaces,
        estimate: &Estimate,
        dt_s: f64,
    ) -> Surfaces {
        if !self.jammed.has_left_one() || self.is_on_runway() {
            return outputs;
        }
        let schedule = self.schedule();
        let mut outputs = outputs;
        outputs.rudder = self.jammed.rudder_stays.unwrap_or(outputs.rudder);
        if let Some(trim) = self.jammed.aileron_trim {
            let bank_rad = self.jammed.most_bank_rad(self.setpoints.roll_rad.abs());
            let bank_rad = libm::copysign(bank_rad, self.setpoints.roll_rad);
            let rudder_trim = self.jammed.rudder.output();
            outputs.rudder =
                self.jammed
                    .by_rudder
                    .step(bank_rad, rudder_trim, estimate, schedule, dt_s);
            let roll_radps = self.heading.roll_rate_for(bank_rad, estimate, schedule);
            let by_ailerons =
                self.heading
                    .surfaces_for(roll_radps, trim, rudder_trim, estimate, schedule);
            outputs.aileron = by_ailerons.aileron;
        }
        if let Some(trim) = self.jammed.elevator_trim {
            let error_radps = -estimate.body_rates.pitch_radps;
            let elevator = self.altitude.elevator_for(error_radps, 0.0, trim, schedule);
            outputs.elevator = elevator.clamp(-1.0, 1.0);
            if !self.glides && self.runway().is_none() && !self.recovery.is_active() {
                let level = self.jammed.throttle.output();
                let (throttle, climb_rate_mps) = self.jammed.by_throttle.step(
                    self.targets.altitude_m,
                    level,
                    estimate,
                    &self.config.airspeed,
                    dt_s,
                );
                outputs.throttle = throttle;
                self.setpoints.climb_rate_mps = climb_rate_mps;
            }
        }
        outputs
    }

    /// What is reported.
    pub(super) const fn jammed_conditions(&self) -> Flags {
        Flags::NONE.with(flags::NOT_FOLLOWED, self.jammed.has_left_one())
    }
}
