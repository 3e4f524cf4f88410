//! Whether attitude and body rates agree in flight, and which of them is believed.

use libm::{atan2, hypot, sqrt};

use super::attitude::{rotation_about, turn};
use super::motion_witness::{MotionWitness, WitnessInput};
use fcc_core::blocks::{LowPass, limit_abs, wrap_pi};
use fcc_core::flight::orientation::{
    EulerAngles, earth_to_body, euler_from_quaternion, product, quaternion_from_euler,
};
use fcc_core::flight::{Attitude, BodyRates};

/// The integrated rates follow the attitude with this bandwidth, rad/s, and learn
/// their bias, at most this one, rad/s (2 °/s: four standard deviations of a phone's
/// gyroscope before calibration, 0.5 °/s).
const FOLLOWS_RADPS: f64 = 0.04;
/// At first with this over the time that was followed, since the bias is not known yet.
const FIRST_RAD: f64 = 1.0;
const MOST_LEARNED_RADPS: f64 = 0.035;
/// The same while the rates are doubted: they agree when their offset is that of
/// some seconds.
const FOLLOWS_DOUBTED_RADPS: f64 = 1.0;
/// They contradict each other beyond this angle, rad (3.5°), after this lag, s: more
/// than noise and an attitude that is 0.1 s late make of a fast roll.
const DIFFERS_RAD: f64 = 0.061;
const DIFFERENCE_LAG_S: f64 = 0.3;
/// So many standard deviations of a computed attitude are no contradiction, either.
const EXPECTED_SIGMAS: f64 = 3.0;
/// The odds of one against the other at which it is decided, 20 to 1, and those that are
/// enough beyond this angle, rad (15°), 3 to 1.
const CERTAIN: f64 = 3.0;
const LARGE_RAD: f64 = 0.26;
const CERTAIN_IF_LARGE: f64 = 1.1;
/// An offset of the rates up to this is flown, as the attitude corrects it, rad/s (4 °/s);
/// doubted rates agree below this one (1.5 °/s).
const FLOWN_RADPS: f64 = 0.07;
const RATES_AGREE_RADPS: f64 = 0.026;
/// A doubted attitude agrees within this angle, rad (3°).
const ATTITUDE_AGREES_RAD: f64 = 0.052;
/// What is doubted is believed again when it has agreed for this time, s.
const BELIEVED_AFTER_S: f64 = 5.0;

/// They are compared so often, s; the rates are integrated in each tick.
const COMPARED_EACH_S: f64 = 0.09;

/// What is doubted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MotionDoubt {
    /// The attitude turns as the rates do not show, and neither do forces, path and
    /// heading.
    Attitude,
    /// The rates turn as neither attitude nor the others show.
    BodyRates,
}

/// One tick's inputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionInput {
    /// Attitude and body rates, if both are measured.
    pub(super) measured: Option<(Attitude, BodyRates)>,
    /// What navigation makes of them.
    pub(super) flown: EulerAngles,
    pub(super) witness: WitnessInput,
    /// The standard deviation of the attitude, if it is computed, rad.
    pub(super) sigma_rad: f64,
    /// Whether one may be doubted: while engaged.
    pub(super) may_doubt: bool,
}

/// A contradiction that is not decided yet.
#[derive(Clone, Copy, Debug)]
struct Suspicion {
    lasted_s: f64,
    /// The difference at its beginning, rad.
    began_rad: [f64; 2],
    /// Logarithm of the odds that the attitude is right.
    odds: f64,
}

/// Compares the attitude with the integrated body rates.
///
/// The integral follows the attitude so slowly that a step or a drift of either shows as a
/// difference. Which of the two is wrong is told by what comes from neither, in a
/// sequential test of two hypotheses (Wald 1945).
#[derive(Clone, Debug)]
pub(super) struct MotionMonitor {
    /// The integrated rates: from body axes to earth axes.
    rotation: Option<[f64; 4]>,
    /// For how long the attitude was followed, s.
    followed_s: f64,
    /// The learned bias of the rates, rad/s.
    offset_radps: [f64; 3],
    /// About x and y: attitude less integrated rates, rad.
    difference: [LowPass; 2],
    witness: MotionWitness,
    suspicion: Option<Suspicion>,
    doubt: Option<MotionDoubt>,
    /// Logarithm of the odds that a doubted attitude is right.
    odds_since_doubt: f64,
    agrees_s: f64,
    /// The standard deviation of the attitude in the latest seconds, rad.
    sigma_rad: f64,
    /// The time since they were compared last, s.
    passed_s: f64,
    /// Whether one might be doubted in the last tick.
    might_doubt: bool,
}

impl MotionMonitor {
    pub(super) const fn new() -> Self {
        Self {
            rotation: None,
            followed_s: 0.0,
            offset_radps: [0.0; 3],
            difference: [LowPass::new(DIFFERENCE_LAG_S); 2],
            witness: MotionWitness::new(),
            suspicion: None,
            doubt: None,
            odds_since_doubt: 0.0,
            agrees_s: 0.0,
            sigma_rad: 0.0,
            passed_s: 0.0,
            might_doubt: false,
        }
    }

    /// The same from now on, with the learned bias of the rates.
    pub(super) const fn renewed(&self) -> Self {
        Self {
            followed_s: self.followed_s,
            offset_radps: self.offset_radps,
            ..Self::new()
        }
    }

    pub(super) const fn doubt(&self) -> Option<MotionDoubt> {
        self.doubt
    }

    /// The learned bias of the rates, rad/s.
    pub(super) const fn rate_bias_radps(&self) -> [f64; 3] {
        self.offset_radps
    }

    /// Whether one of them may be wrong.
    pub(super) const fn suspects(&self) -> bool {
        self.suspicion.is_some()
    }

    /// Processes one tick; the rotation by the rates when the attitude begins to be doubted.
    pub(super) fn step(&mut self, input: &MotionInput, dt_s: f64) -> Option<[f64; 4]> {
        if !input.may_doubt {
            self.doubt = None;
        }
        let might_doubt = core::mem::replace(&mut self.might_doubt, input.may_doubt);
        if input.may_doubt && !might_doubt {
            // What an attitude that was still found has turned is no failure.
            self.rotation = None;
            self.suspicion = None;
        }
        let Some((attitude, rates)) = input.measured else {
            self.rotation = None;
            self.suspicion = None;
            self.agrees_s = 0.0;
            return None;
        };
        self.integrate(rates, dt_s);
        self.sigma_rad = input
            .sigma_rad
            .max(self.sigma_rad * (1.0 - FOLLOWS_RADPS * dt_s));
        self.passed_s += dt_s;
        if self.passed_s < COMPARED_EACH_S {
            return None;
        }
        let passed_s = core::mem::take(&mut self.passed_s);
        self.compare(attitude, input, passed_s)
    }

    /// Integrates the rates without their offset.
    fn integrate(&mut self, rates: BodyRates, dt_s: f64) {
        let [x, y, z] = self.offset_radps;
        let rates = BodyRates {
            roll_radps: rates.roll_radps - x,
            pitch_radps: rates.pitch_radps - y,
            yaw_radps: rates.yaw_radps - z,
        };
        self.rotation = self
            .rotation
            .map(|before| product(before, turn(&rates, dt_s)));
    }

    fn compare(&mut self, attitude: Attitude, input: &MotionInput, dt_s: f64) -> Option<[f64; 4]> {
        let measured = quaternion_from_euler(EulerAngles {
            roll_rad: attitude.roll_rad,
            pitch_rad: attitude.pitch_rad,
            heading_rad: input.flown.heading_rad,
        });
        let without_attitude = if self.doubt == Some(MotionDoubt::Attitude) {
            Some(input.flown)
        } else {
            self.rotation.map(euler_from_quaternion)
        };
        let apart = without_attitude.map_or([0.0; 2], |other| {
            [
                wrap_pi(attitude.roll_rad - other.roll_rad),
                attitude.pitch_rad - other.pitch_rad,
            ]
        });
        let learns = self.doubt.is_none() && self.suspicion.is_none();
        self.witness
            .step(&input.witness, attitude, apart, learns, dt_s);
        if self.doubt == Some(MotionDoubt::Attitude) {
            return self.judge_doubted_attitude(measured, input, dt_s);
        }
        let Some(rotation) = self.rotation else {
            self.follow(measured);
            return None;
        };
        let off = between(rotation, measured);
        let [x, y] = off;
        let [lag_x, lag_y] = &mut self.difference;
        let difference = [lag_x.step(x, dt_s), lag_y.step(y, dt_s)];
        if self.doubt.is_some() {
            self.correct(measured, off, (FOLLOWS_DOUBTED_RADPS, f64::INFINITY), dt_s);
            let [x, y, _] = self.offset_radps;
            self.follow_doubted(hypot(x, y) < RATES_AGREE_RADPS, measured, dt_s);
            return None;
        }
        let [x, y] = difference;
        if hypot(x, y) < self.expected_rad() {
            self.suspicion = None;
            self.followed_s += dt_s;
            let bandwidth_radps = FOLLOWS_RADPS.max(FIRST_RAD / self.followed_s.max(1.0));
            self.correct(measured, off, (bandwidth_radps, MOST_LEARNED_RADPS), dt_s);
            return None;
        }
        self.judge(difference, measured, input, dt_s)
    }

    /// Up to which angle a difference is none: an attitude that is uncertain is found later.
    fn expected_rad(&self) -> f64 {
        hypot(DIFFERS_RAD, EXPECTED_SIGMAS * self.sigma_rad)
    }

    /// Collects evidence for attitude or rates, and decides when it is enough.
    fn judge(
        &mut self,
        difference: [f64; 2],
        measured: [f64; 4],
        input: &MotionInput,
        dt_s: f64,
    ) -> Option<[f64; 4]> {
        let mut suspicion = self.suspicion.unwrap_or(Suspicion {
            lasted_s: 0.0,
            began_rad: difference,
            odds: 0.0,
        });
        suspicion.lasted_s += dt_s;
        suspicion.odds += self.witness.odds(&input.witness, dt_s);
        self.suspicion = Some(suspicion);
        let [x, y] = difference;
        let needed = if hypot(x, y) > LARGE_RAD {
            CERTAIN_IF_LARGE
        } else {
            CERTAIN
        };
        if suspicion.odds.abs() < needed {
            return None;
        }
        let by_rates = self.rotation;
        self.follow(measured);
        if suspicion.odds < 0.0 {
            self.odds_since_doubt = 0.0;
            self.doubt = input.may_doubt.then_some(MotionDoubt::Attitude);
            return by_rates.filter(|_| input.may_doubt);
        }
        let [began_x, began_y] = suspicion.began_rad;
        let [offset_x, offset_y, _] = &mut self.offset_radps;
        *offset_x -= (x - began_x) / suspicion.lasted_s;
        *offset_y -= (y - began_y) / suspicion.lasted_s;
        let is_large = hypot(*offset_x, *offset_y) > FLOWN_RADPS;
        self.doubt = (input.may_doubt && is_large).then_some(MotionDoubt::BodyRates);
        None
    }

    /// Goes on collecting evidence while the attitude is doubted: if the one that is flown
    /// without it turns out to be the wrong one, the rates from which that comes are doubted
    /// instead, and the attitude is adopted.
    fn judge_doubted_attitude(
        &mut self,
        measured: [f64; 4],
        input: &MotionInput,
        dt_s: f64,
    ) -> Option<[f64; 4]> {
        self.rotation = None;
        let [x, y] = between(quaternion_from_euler(input.flown), measured);
        let agrees = hypot(x, y) < ATTITUDE_AGREES_RAD;
        let odds = (self.odds_since_doubt + self.witness.odds(&input.witness, dt_s)).max(-CERTAIN);
        self.odds_since_doubt = odds;
        if odds < CERTAIN || hypot(x, y) < self.expected_rad() {
            self.follow_doubted(agrees, measured, dt_s);
            return None;
        }
        self.follow(measured);
        self.doubt = Some(MotionDoubt::BodyRates);
        Some(measured)
    }

    /// The integral continues from the attitude.
    fn follow(&mut self, measured: [f64; 4]) {
        self.rotation = Some(measured);
        self.witness.agree();
        self.suspicion = None;
        self.difference = [LowPass::new(DIFFERENCE_LAG_S); 2];
        self.agrees_s = 0.0;
    }

    /// Believes what is doubted again when it has agreed for some time.
    fn follow_doubted(&mut self, agrees: bool, measured: [f64; 4], dt_s: f64) {
        let agrees_s = if agrees { self.agrees_s + dt_s } else { 0.0 };
        if agrees_s > BELIEVED_AFTER_S {
            self.doubt = None;
            self.follow(measured);
        } else {
            self.agrees_s = agrees_s;
        }
    }

    /// Corrects the integral, critically damped, and its bias up to a limit: about x and y by
    /// the attitude, about z by the heading.
    fn correct(
        &mut self,
        measured: [f64; 4],
        [x, y]: [f64; 2],
        (bandwidth_radps, most_radps): (f64, f64),
        dt_s: f64,
    ) {
        let Some(rotation) = self.rotation else {
            return;
        };
        let off = [x, y, about_z(rotation, measured)];
        let length = sqrt(off.iter().map(|rad| rad * rad).sum());
        if length > 0.0 {
            let angle = (2.0 * bandwidth_radps * dt_s).min(1.0) * length;
            self.rotation = Some(product(rotation, rotation_about(off, length, angle)));
        }
        for (offset, off) in self.offset_radps.iter_mut().zip(off) {
            let learned = *offset - bandwidth_radps * bandwidth_radps * off * dt_s;
            // One that is larger was measured when it was decided.
            let most_radps = most_radps.max(offset.abs());
            *offset = limit_abs(learned, most_radps);
        }
    }
}

/// The rotation about z of the body from one orientation to another, rad.
fn about_z([w, x, y, z]: [f64; 4], to: [f64; 4]) -> f64 {
    let [w, _, _, z] = product([w, -x, -y, -z], to);
    2.0 * atan2(z, w.abs()) * w.signum()
}

/// The rotation about x and y that brings gravity from one direction in body axes to another,
/// rad.
fn between(from: [f64; 4], to: [f64; 4]) -> [f64; 2] {
    const DOWN: [f64; 3] = [0.0, 0.0, 1.0];
    let [ax, ay, az] = earth_to_body(to, DOWN);
    let [bx, by, bz] = earth_to_body(from, DOWN);
    let [x, y, z] = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    let length = sqrt(x * x + y * y + z * z);
    if length > 0.0 {
        let angle = atan2(length, ax * bx + ay * by + az * bz);
        [x * angle / length, y * angle / length]
    } else {
        [0.0; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight and level at 55 m/s in light gusts: the heading swings.
    fn input(roll_rad: f64, time_s: f64, may_doubt: bool) -> MotionInput {
        let attitude = Attitude {
            roll_rad,
            pitch_rad: 0.0,
        };
        MotionInput {
            measured: Some((attitude, BodyRates::default())),
            flown: EulerAngles {
                roll_rad,
                ..EulerAngles::default()
            },
            witness: WitnessInput {
                forward_mps2: Some(0.0),
                heading_rad: Some(0.02 * (0.5 * time_s).sin()),
                airspeed_mps: Some(55.0),
                climb_rate_mps: Some(0.0),
                angle_of_attack_rad: 0.0,
                gusts_mps: 0.5,
            },
            sigma_rad: 0.0,
            may_doubt,
        }
    }

    fn doubts(jumps_at_s: f64) -> bool {
        let mut monitor = MotionMonitor::new();
        (0..4_000_u32).any(|tick| {
            let time_s = f64::from(tick) * 0.025;
            let roll_rad = if time_s < jumps_at_s { -0.07 } else { 0.0 };
            monitor.step(&input(roll_rad, time_s, time_s > 15.0), 0.025);
            monitor.doubt().is_some()
        })
    }

    /// A filter that is switched on finds its attitude, by 4° within a second, which no
    /// gyroscope shows.
    #[test]
    fn an_attitude_that_is_found_before_engaging_is_not_doubted_after_it() {
        assert!(!doubts(2.0));
    }

    /// The same in flight.
    #[test]
    fn an_attitude_that_jumps_in_flight_is_doubted() {
        assert!(doubts(20.0));
    }
}
