//! What replaces a lost gyroscope, and what a lost attitude.

use core::time::Duration;

use libm::{asin, atan2, cos, exp, sin};

use super::estimate::Estimate;
use super::force_sample::LEAST_AIRSPEED_MPS;
use super::quantity::{Quantities, Quantity};
use fcc_core::blocks::{LowPass, limit_abs, wrap_pi};
use fcc_core::flight::{Attitude, BodyRates, Measurements};
use fcc_core::framework::{Reading, Time};
use fcc_core::units::GRAVITY_MPS2;

/// The bandwidth of angle rates, rad/s: the rates are late by 2/25 s, a quarter
/// of the pitch loop's time constant, and the noise of 0.1° in 40 samples a
/// second becomes 1 °/s.
const ANGLE_RADPS: f64 = 25.0;
/// How late body rates are that replace a lost gyroscope, s.
pub const DERIVED_RATES_LATE_S: f64 = 2.0 / ANGLE_RADPS;
/// The bandwidth of the acceleration along the path, rad/s: that of a gust is
/// not one of the aircraft.
const PATH_RADPS: f64 = 1.0;
/// Gravity corrects the integrated attitude with this time constant, s: long
/// against gusts, and with a gyroscope's bias of 0.1 °/s an error of 1°.
const GRAVITY_TAU_S: f64 = 10.0;
/// The time constant with which the difference between attitude and gravity is
/// learned while both are measured, s, and its largest value, rad (5°).
const OFFSET_TAU_S: f64 = 20.0;
const MOST_OFFSET_RAD: f64 = 0.087;
/// After a longer gap a rate is unknown: it begins at 0.
const GAP: Duration = Duration::from_millis(500);

/// Value and rate of change of a measured quantity: a critically damped α-β
/// filter (Kalata 1984; Bar-Shalom, Li and Kirubarajan 2001, section 6.5).
#[derive(Clone, Copy, Debug)]
struct Slope {
    bandwidth_radps: f64,
    taken: Time,
    value: f64,
    per_s: f64,
}

impl Slope {
    const fn new(bandwidth_radps: f64) -> Self {
        Self {
            bandwidth_radps,
            taken: Time::NEVER,
            value: 0.0,
            per_s: 0.0,
        }
    }

    /// Processes a sample; `difference` is that of the sample from a value.
    fn step(&mut self, taken: Time, sample: f64, difference: impl Fn(f64, f64) -> f64) {
        if taken <= self.taken {
            return;
        }
        let gap = taken.since(self.taken);
        let is_first = self.taken.is_never() || gap > GAP;
        self.taken = taken;
        if is_first {
            (self.value, self.per_s) = (sample, 0.0);
            return;
        }
        let gap_s = gap.as_secs_f64();
        let kept = exp(-self.bandwidth_radps * gap_s);
        let predicted = self.value + self.per_s * gap_s;
        let error = difference(sample, predicted);
        self.value = predicted + (1.0 - kept * kept) * error;
        self.per_s += (1.0 - kept) * (1.0 - kept) / gap_s * error;
    }
}

/// Replaces a lost gyroscope by the derivative of attitude and heading, and a
/// lost attitude by gravity, with which the integrated gyroscope is corrected:
/// gravity is the acceleration, which airspeed and turn rates tell, without the
/// specific force (Euston, Coote, Mahony, Kim and Hamel 2008, section III).
#[derive(Clone, Debug)]
pub struct Replacement {
    roll: Slope,
    pitch: Slope,
    heading: Slope,
    path: Slope,
    /// Attitude without that of gravity, rad.
    roll_offset: LowPass,
    pitch_offset: LowPass,
    /// The share of an attitude that navigation takes over as fast as
    /// `GRAVITY_TAU_S` says.
    share: f64,
}

impl Replacement {
    /// `attitude_tau_s` is navigation's.
    pub const fn new(attitude_tau_s: f64) -> Self {
        Self {
            roll: Slope::new(ANGLE_RADPS),
            pitch: Slope::new(ANGLE_RADPS),
            heading: Slope::new(ANGLE_RADPS),
            path: Slope::new(PATH_RADPS),
            roll_offset: LowPass::new(OFFSET_TAU_S),
            pitch_offset: LowPass::new(OFFSET_TAU_S),
            share: attitude_tau_s / GRAVITY_TAU_S,
        }
    }

    /// Follows the measurements, before the estimate of this tick; of those that
    /// are lost nothing is taken.
    pub fn follow(
        &mut self,
        measured: &Measurements,
        lost: Quantities,
        estimate: &Estimate,
        dt_s: f64,
    ) {
        let minus = |a: f64, b: f64| a - b;
        if !lost.contains(Quantity::Attitude) {
            let Reading { value, taken, .. } = measured.attitude;
            self.roll.step(taken, value.roll_rad, |a, b| wrap_pi(a - b));
            self.pitch.step(taken, value.pitch_rad, minus);
        }
        if !lost.contains(Quantity::Heading) {
            let Reading { value, taken, .. } = measured.heading_rad;
            self.heading.step(taken, value, |a, b| wrap_pi(a - b));
        }
        if !lost.contains(Quantity::Airspeed) {
            let Reading { value, taken, .. } = measured.airspeed_mps;
            self.path.step(taken, value, minus);
        }
        if lost.is_empty() {
            let upright = self.by_gravity(measured, estimate, false);
            let attitude = measured.attitude.value;
            let roll_rad = wrap_pi(attitude.roll_rad - upright.roll_rad);
            let pitch_rad = attitude.pitch_rad - upright.pitch_rad;
            self.roll_offset
                .step(limit_abs(roll_rad, MOST_OFFSET_RAD), dt_s);
            self.pitch_offset
                .step(limit_abs(pitch_rad, MOST_OFFSET_RAD), dt_s);
        }
    }

    /// The attitude was wrong while the difference to it was learned.
    pub const fn forget_offsets(&mut self) {
        self.roll_offset.reset(0.0);
        self.pitch_offset.reset(0.0);
    }

    /// The angles so far were wrong: what is derived from them begins anew.
    pub const fn forget_angles(&mut self) {
        self.roll = Slope::new(ANGLE_RADPS);
        self.pitch = Slope::new(ANGLE_RADPS);
        self.heading = Slope::new(ANGLE_RADPS);
        self.forget_offsets();
    }

    /// The measurements without those that are lost, some of them replaced.
    pub fn without(
        &self,
        measured: &Measurements,
        lost: Quantities,
        estimate: &Estimate,
        now: Time,
    ) -> Measurements {
        let mut left = *measured;
        if lost.contains(Quantity::Attitude) {
            left.attitude.taken = Time::NEVER;
            if !lost.contains(Quantity::BodyRates) && !lost.contains(Quantity::SpecificForce) {
                let upright =
                    self.by_gravity(measured, estimate, lost.contains(Quantity::Airspeed));
                let toward =
                    |is_rad: f64, to_rad: f64| is_rad + self.share * wrap_pi(to_rad - is_rad);
                let attitude = Attitude {
                    pitch_rad: toward(
                        estimate.pitch_rad,
                        upright.pitch_rad + self.pitch_offset.output(),
                    ),
                    roll_rad: toward(
                        estimate.roll_rad,
                        upright.roll_rad + self.roll_offset.output(),
                    ),
                };
                left.attitude = Reading::new(attitude, now);
            }
        }
        if lost.contains(Quantity::BodyRates) {
            left.body_rates.taken = Time::NEVER;
            if !lost.contains(Quantity::Attitude) {
                left.body_rates = Reading::new(self.rates(lost, estimate), now);
            }
        }
        if lost.contains(Quantity::Heading) {
            left.heading_rad.taken = Time::NEVER;
        }
        if lost.contains(Quantity::SpecificForce) {
            left.specific_force.taken = Time::NEVER;
        }
        if lost.contains(Quantity::Airspeed) {
            left.airspeed_mps.taken = Time::NEVER;
        }
        if lost.contains(Quantity::Altitude) {
            left.altitude_m.taken = Time::NEVER;
        }
        left
    }

    /// Body rates from the rates of the angles (Stevens, Lewis and Johnson 2016,
    /// equation 1.4-4); without a heading those of a coordinated turn.
    fn rates(&self, lost: Quantities, estimate: &Estimate) -> BodyRates {
        let (sin_roll, cos_roll) = (sin(self.roll.value), cos(self.roll.value));
        let (sin_pitch, cos_pitch) = (sin(self.pitch.value), cos(self.pitch.value));
        let heading_radps = if lost.contains(Quantity::Heading) {
            let speed = estimate.true_airspeed_mps.max(LEAST_AIRSPEED_MPS);
            GRAVITY_MPS2 / speed * sin_roll / cos_roll.max(0.5)
        } else {
            self.heading.per_s
        };
        BodyRates {
            roll_radps: self.roll.per_s - heading_radps * sin_pitch,
            pitch_radps: self.pitch.per_s * cos_roll + heading_radps * cos_pitch * sin_roll,
            yaw_radps: heading_radps * cos_pitch * cos_roll - self.pitch.per_s * sin_roll,
        }
    }

    /// The attitude by gravity: by the specific force without the accelerations
    /// of the turn and along the path.
    fn by_gravity(
        &self,
        measured: &Measurements,
        estimate: &Estimate,
        lost_airspeed: bool,
    ) -> Attitude {
        let (force, rates) = (measured.specific_force.value, measured.body_rates.value);
        let speed = estimate.true_airspeed_mps;
        let along_mps2 = if lost_airspeed { 0.0 } else { self.path.per_s };
        let right = rates.yaw_radps * speed - force.y_mps2;
        let down = -rates.pitch_radps * speed - force.z_mps2;
        let forward = (force.x_mps2 - along_mps2) / GRAVITY_MPS2;
        Attitude {
            pitch_rad: asin(limit_abs(forward, 1.0)),
            roll_rad: atan2(right, down),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_core::flight::SpecificForce;

    const DT_S: f64 = 0.025;

    /// A coordinated turn at 30° of bank and 50 m/s turns by g tan φ / V =
    /// 6.49 °/s (FAA-H-8083-25B, chapter 5); an accelerometer alone feels no
    /// bank in it.
    #[test]
    fn gravity_is_known_in_a_coordinated_turn() {
        let (roll_rad, speed) = (30.0_f64.to_radians(), 50.0);
        let turn_radps = 6.488_f64.to_radians();
        let measured = Measurements {
            specific_force: Reading::new(
                SpecificForce {
                    z_mps2: -GRAVITY_MPS2 / cos(roll_rad),
                    ..SpecificForce::default()
                },
                Time::from_nanos(1),
            ),
            body_rates: Reading::new(
                BodyRates {
                    pitch_radps: turn_radps * sin(roll_rad),
                    yaw_radps: turn_radps * cos(roll_rad),
                    ..BodyRates::default()
                },
                Time::from_nanos(1),
            ),
            ..Measurements::default()
        };
        let estimate = Estimate {
            true_airspeed_mps: speed,
            ..Estimate::default()
        };
        let attitude = Replacement::new(1.36).by_gravity(&measured, &estimate, true);
        assert!((attitude.roll_rad.to_degrees() - 30.0).abs() < 0.1);
        assert!(attitude.pitch_rad.abs() < 1e-9);
    }

    /// A roll of 10 °/s through north while the nose rises by 2 °/s.
    #[test]
    fn the_derivative_of_attitude_is_the_gyroscope() {
        let mut replacement = Replacement::new(1.36);
        let estimate = Estimate::default();
        let mut measured = Measurements::default();
        for n in 1..=80_i32 {
            let now = Time::from_nanos(i64::from(n) * 25_000_000);
            let passed_s = f64::from(n) * DT_S;
            let attitude = Attitude {
                roll_rad: (10.0 * (passed_s - 2.0)).to_radians(),
                pitch_rad: (2.0 * passed_s).to_radians(),
            };
            measured.attitude = Reading::new(attitude, now);
            let north = (3.0 * (passed_s - 1.0)).to_radians();
            measured.heading_rad = Reading::new(fcc_core::blocks::wrap_two_pi(north), now);
            replacement.follow(&measured, Quantities::NONE, &estimate, DT_S);
        }
        let lost = Quantity::BodyRates.alone();
        let now = Time::from_nanos(2_000_000_000);
        let rates = replacement
            .without(&measured, lost, &estimate, now)
            .body_rates;
        let sin_pitch = 4.0_f64.to_radians().sin();
        let rates = rates.value;
        assert!((rates.roll_radps.to_degrees() - (10.0 - 3.0 * sin_pitch)).abs() < 0.05);
        assert!((rates.pitch_radps.to_degrees() - 2.0).abs() < 0.05);
        assert!((rates.yaw_radps.to_degrees() - 3.0).abs() < 0.05);
    }
}
