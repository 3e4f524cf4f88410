//! In-flight alignment: the attitude that explains how a receiver's velocity changed in the
//! latest seconds, whatever was believed before.
//!
//! With C the rotation from the body's axes to those that it had once, by the gyroscopes
//! alone, and R from those to the earth's, v(t) = v₀ + R ∫ C f dt + g t. R is that of the least
//! squares (Wu and Pan 2013, *Velocity/Position Integration Formula Part I: Application to
//! In-Flight Coarse Alignment*, IEEE Transactions on Aerospace and Electronic Systems 49(2);
//! solved as in Horn 1987, *Closed-form solution of absolute orientation using unit
//! quaternions*).

mod changes;
mod sums;

use nalgebra::{UnitQuaternion, Vector3};

use changes::Changes;
use sums::Sums;

use super::motion::{Raw, turn};
use super::states::UNKNOWN_ANGLE;
use super::{earlier, signed_s};
use fcc_core::framework::Time;

/// Velocities, how far apart they are at least, s, and over how long they are compared: not
/// less, because they differ by their noise, and not more, because gyroscopes are not perfect.
const VELOCITIES: usize = 32;
const VELOCITIES_APART_S: f64 = 0.15;
const LEAST_S: f64 = 2.5;
const LONGEST_S: f64 = 4.0;
const LEAST_VELOCITIES: usize = 4;
/// By what they may be late, in steps, s.
const LATENESSES: u32 = 21;
const LATENESS_APART_S: f64 = 0.1;
/// How often they are compared, s.
const EVERY_S: f64 = 0.5;
/// The largest biases that a sensor has, rad/s, m/s².
pub(super) const LARGEST_RATE_BIAS: f64 = 0.05;
pub(super) const LARGEST_FORCE_BIAS: f64 = 0.5;
/// A velocity is not better than this, m/s.
pub(super) const RECEIVER_MPS: f64 = 0.5;
/// The attitude that is believed is wrong if it leaves so many times what the best one leaves,
/// and as many times this, m/s; and if the best one leaves no more than this, m/s, and no more
/// than this share of the changes, and its horizon is as sure as this, rad².
const CLEARLY: f64 = 5.0;
const LEAST_MPS: f64 = 0.5;
const LEFT_MPS: f64 = 0.6;
const LEFT_SHARE: f64 = 0.1;
const SURE: f64 = 0.01;
/// Twice the same rotation was found within this, rad.
const SAME: f64 = 0.15;

/// The sums of specific force and the velocities.
#[derive(Clone, Debug)]
pub(super) struct InFlight {
    /// With the biases that are believed, and with none but those that a sensor may have.
    believed: Sums,
    credible: Sums,
    velocities: [Velocity; VELOCITIES],
    next_velocity: usize,
    compared: Time,
    /// The rotation that was found last.
    found: Option<UnitQuaternion<f64>>,
}

/// A receiver's velocity.
#[derive(Clone, Copy, Debug)]
struct Velocity {
    taken: Time,
    mps: Vector3<f64>,
}

const NONE: Velocity = Velocity {
    taken: Time::NEVER,
    mps: Vector3::new(0.0, 0.0, 0.0),
};

/// The attitude that explains the velocities.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) attitude: UnitQuaternion<f64>,
    /// rad².
    pub(super) variance: Vector3<f64>,
    /// Now, m/s.
    pub(super) velocity: Vector3<f64>,
    /// By how much the velocities are late, s.
    pub(super) late_s: f64,
}

impl InFlight {
    pub(super) fn new() -> Self {
        Self {
            believed: Sums::new(),
            credible: Sums::new(),
            velocities: [NONE; VELOCITIES],
            next_velocity: 0,
            compared: Time::NEVER,
            found: None,
        }
    }

    /// Moves on to a time with the readings of the last `dt_s`, in each half of which the body
    /// turns by `half` as is believed; what is not measured cuts it off.
    pub(super) fn advance(
        &mut self,
        now: Time,
        raw: &Raw,
        half: UnitQuaternion<f64>,
        [rate_bias, force_bias]: [Vector3<f64>; 2],
        dt_s: f64,
    ) {
        let (Some(rates), Some(force)) = (raw.rates, raw.force) else {
            if !self.believed.now.is_never() {
                *self = Self::new();
            }
            return;
        };
        self.believed.advance(now, half, force - force_bias, dt_s);
        let other_bias = credible(rate_bias, LARGEST_RATE_BIAS);
        let half = if other_bias == rate_bias {
            half
        } else {
            turn((rates - other_bias) * (0.5 * dt_s))
        };
        let force = force - credible(force_bias, LARGEST_FORCE_BIAS);
        self.credible.advance(now, half, force, dt_s);
    }

    /// Takes a velocity of a time; whether it is to be compared with those before.
    pub(super) fn take(&mut self, taken: Time, mps: Vector3<f64>) -> bool {
        let last = self.before(1).taken;
        if !last.is_never() && signed_s(taken, last) < VELOCITIES_APART_S {
            return false;
        }
        self.velocities[self.next_velocity] = Velocity { taken, mps };
        self.next_velocity = (self.next_velocity + 1) % VELOCITIES;
        let is_due = self.compared.is_never() || signed_s(taken, self.compared) >= EVERY_S;
        if is_due {
            self.compared = taken;
        }
        is_due
    }

    /// The velocity that was taken so many before the next one.
    const fn before(&self, count: usize) -> &Velocity {
        &self.velocities[(self.next_velocity + VELOCITIES - count) % VELOCITIES]
    }

    /// The changes of the latest velocities, if they come so late.
    fn changes(&self, sums: &Sums, late_s: f64, gravity: Vector3<f64>) -> Option<Changes> {
        let last = self.before(1).taken;
        let mut changes = Changes {
            late_s,
            velocities: [Vector3::zeros(); VELOCITIES],
            sums: [Vector3::zeros(); VELOCITIES],
            count: 0,
        };
        let mut longest_s: f64 = 0.0;
        for one in (1..=VELOCITIES).map(|count| self.before(count)) {
            let age_s = signed_s(last, one.taken);
            if one.taken.is_never() || !(0.0..=LONGEST_S).contains(&age_s) {
                break;
            }
            let Some(sum) = sums.at(earlier(one.taken, late_s)) else {
                break;
            };
            // Less what gravity adds.
            changes.velocities[changes.count] = one.mps + gravity * age_s;
            changes.sums[changes.count] = sum;
            changes.count += 1;
            longest_s = age_s;
        }
        (changes.count >= LEAST_VELOCITIES && longest_s >= LEAST_S).then(|| changes.centred())
    }

    /// Another attitude, if that explains the latest velocities twice and the one that is
    /// believed does not, whatever they are late by.
    pub(super) fn other(
        &mut self,
        believed: UnitQuaternion<f64>,
        late_s: f64,
        gravity: Vector3<f64>,
    ) -> Option<Found> {
        let before = self.found.take();
        let was = believed * self.believed.turned.inverse();
        let by_believed = self.changes(&self.believed, late_s, gravity)?.left(&was);
        let limit = by_believed / (CLEARLY * CLEARLY);
        if limit < LEAST_MPS * LEAST_MPS {
            return None;
        }
        let sums = &self.credible;
        let was = believed * sums.turned.inverse();
        let mut best: Option<(f64, UnitQuaternion<f64>, Changes)> = None;
        let latenesses = (0..LATENESSES).map(|step| f64::from(step) * LATENESS_APART_S);
        for late_s in core::iter::once(late_s).chain(latenesses) {
            let Some(changes) = self.changes(sums, late_s, gravity) else {
                continue;
            };
            let Some(attitude) = changes.attitude(&was) else {
                continue;
            };
            let left = changes.left(&attitude);
            if best.as_ref().is_none_or(|(least, ..)| left < *least) {
                best = Some((left, attitude, changes));
            }
        }
        let (left, attitude, changes) = best?;
        let explains = left < LEFT_MPS * LEFT_MPS
            && left < LEFT_SHARE * LEFT_SHARE * changes.square()
            && left < limit;
        let mut variance = changes.variance(&attitude, left)?;
        if !explains || variance.xy().max() > SURE {
            return None;
        }
        if variance.z > SURE {
            variance.z = UNKNOWN_ANGLE;
        }
        self.found = Some(attitude);
        before.filter(|before| before.angle_to(&attitude) < SAME)?;
        let last = self.before(1);
        let then = earlier(last.taken, changes.late_s);
        let since = sums.sum - sums.at(then)?;
        Some(Found {
            attitude: attitude * sums.turned,
            variance,
            velocity: last.mps + attitude * since + gravity * signed_s(sums.now, then),
            late_s: changes.late_s,
        })
    }
}

/// A bias as far as a sensor may have it: otherwise it was found with a wrong attitude.
pub(super) fn credible(bias: Vector3<f64>, largest: f64) -> Vector3<f64> {
    bias.map(|one| if one.abs() > largest { 0.0 } else { one })
}
