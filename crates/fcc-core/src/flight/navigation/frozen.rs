//! Detects sensors whose readings are frozen while the aircraft moves.
//!
//! A sensor that hangs often keeps sending its last value with new times. An
//! unchanged value alone is no proof: in calm air a good sensor with coarse
//! resolution may give the same value for long. So a quantity is frozen when
//! its bits have stayed the same for some time *and* other quantities show a
//! motion by which it must have changed: the gyroscopes for the attitude and
//! the heading, attitude and heading for the gyroscopes, the climb for the
//! altitude, a change of bank or pitch for airspeed and accelerometers. While
//! nothing moves, a frozen sensor is not detected, and has no effect.
//!
//! The motion shown by other quantities is integrated with a leak, so that
//! their small errors never add up to a motion. A sensor with any noise never
//! repeats its bits, so that it cannot be reported by mistake.

use core::time::Duration;

use libm::{cos, sin};

use super::Estimate;
use super::attitude::MIN_COS_PITCH;
use crate::blocks::wrap_pi;
use crate::flight::Measurements;
use crate::framework::Time;

/// The least number of unchanged readings: a sensor with few readings per
/// second repeats some of them.
const FEWEST_REPEATS: u32 = 10;
/// The time constant of the leak, s: gyroscopes off by 0.5 °/s, or a climb by
/// 1.5 m/s, never reach the limits below.
const LEAK_S: f64 = 10.0;
/// The rotation that attitude, heading or gyroscopes must show, rad (5°): ten
/// times the resolution of a coarse attitude sensor.
const TURNED_RAD: f64 = 0.087;
/// The climb that a barometer must show, m.
const CLIMBED_M: f64 = 15.0;
/// Changes of bank and pitch that change load and drag, rad (10°, 4°): well
/// beyond those of a trimmed aircraft in calm air.
const BANKED_RAD: f64 = 0.175;
const PITCHED_RAD: f64 = 0.07;
/// Unchanged means the same to the last bit, ...
const EXACTLY: f64 = 0.0;
/// ... except for a specific force computed from an acceleration over the
/// ground, which involves rounding, m/s²: a tenth of the noise of the best
/// small accelerometers.
const SAME_FORCE_MPS2: f64 = 1e-3;
/// The age up to which the climb rate is taken from the ground velocity;
/// otherwise it is computed from the pitch.
const CURRENT: Duration = Duration::from_millis(500);

/// One quantity and how long it has been unchanged.
#[derive(Clone, Copy, Debug)]
struct StuckDetector<const N: usize> {
    values: [f64; N],
    taken: Time,
    repeats: u32,
    for_s: f64,
    is_frozen: bool,
}

impl<const N: usize> StuckDetector<N> {
    const fn new(values: [f64; N], taken: Time) -> Self {
        Self {
            values,
            taken,
            repeats: 0,
            for_s: 0.0,
            is_frozen: false,
        }
    }

    /// Whether the value differs from the previous one by more than
    /// `tolerance`; `dt_s` of the plant's time have passed.
    fn has_changed(&mut self, values: [f64; N], tolerance: f64, taken: Time, dt_s: f64) -> bool {
        let differs = |(is, was): (&f64, &f64)| (is - was).abs() > tolerance;
        if taken.is_never() || values.iter().zip(&self.values).any(differs) {
            *self = Self::new(values, taken);
            return true;
        }
        if taken > self.taken {
            self.taken = taken;
            self.repeats = self.repeats.saturating_add(1);
        }
        self.for_s += dt_s;
        false
    }

    /// Updates the result, given whether it must have changed. Once frozen it
    /// stays frozen until it changes.
    fn update(&mut self, must_have_changed: bool, after_s: f64) {
        let lasts = self.for_s >= after_s && self.repeats >= FEWEST_REPEATS;
        self.is_frozen |= lasts && must_have_changed;
    }
}

/// An integrator with a leak.
#[derive(Clone, Copy, Debug, Default)]
struct LeakyIntegrator(f64);

impl LeakyIntegrator {
    fn add(&mut self, amount: f64, dt_s: f64) {
        self.0 += amount - self.0 * (dt_s / LEAK_S).min(1.0);
    }

    fn exceeds(self, limit: f64) -> bool {
        self.0.abs() > limit
    }
}

/// Which of the quantities needed by control are frozen.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "six quantities, each frozen or not"
)]
pub(crate) struct Frozen {
    pub(crate) attitude: bool,
    pub(crate) heading: bool,
    pub(crate) body_rates: bool,
    pub(crate) specific_force: bool,
    pub(crate) airspeed: bool,
    pub(crate) altitude: bool,
}

/// Roll, pitch and heading, rad, or their rates.
type Angles = [f64; 3];

/// Monitors the six quantities needed by control.
#[derive(Clone, Debug)]
pub(crate) struct FrozenDetector {
    /// 0 switches the check off.
    after_s: f64,
    roll: StuckDetector<1>,
    pitch: StuckDetector<1>,
    heading: StuckDetector<1>,
    rates: StuckDetector<3>,
    force: StuckDetector<3>,
    airspeed: StuckDetector<1>,
    altitude: StuckDetector<1>,
    /// Rotation by the gyroscopes since roll, pitch and heading changed.
    turned: [LeakyIntegrator; 3],
    /// Rotation by attitude and heading minus that by the gyroscopes, since the
    /// gyroscopes changed.
    unsaid: [LeakyIntegrator; 3],
    /// Climb since the altitude changed.
    climbed: LeakyIntegrator,
    /// Climb rate minus the one computed from the pitch, when the altitude
    /// changed.
    climb_at_level_mps: f64,
    /// The attitude when specific force and airspeed changed.
    force_at: Angles,
    airspeed_at: Angles,
    /// The measured attitude and heading of the previous tick.
    before: Option<Angles>,
}

impl FrozenDetector {
    /// A value must have been unchanged for `after_s` of the plant's time; 0
    /// switches the check off.
    pub(crate) const fn new(after_s: f64) -> Self {
        Self {
            after_s,
            roll: StuckDetector::new([0.0], Time::NEVER),
            pitch: StuckDetector::new([0.0], Time::NEVER),
            heading: StuckDetector::new([0.0], Time::NEVER),
            rates: StuckDetector::new([0.0; 3], Time::NEVER),
            force: StuckDetector::new([0.0; 3], Time::NEVER),
            airspeed: StuckDetector::new([0.0], Time::NEVER),
            altitude: StuckDetector::new([0.0], Time::NEVER),
            turned: [LeakyIntegrator(0.0); 3],
            unsaid: [LeakyIntegrator(0.0); 3],
            climbed: LeakyIntegrator(0.0),
            climb_at_level_mps: 0.0,
            force_at: [0.0; 3],
            airspeed_at: [0.0; 3],
            before: None,
        }
    }

    /// Processes the measurements at `now`, `dt_s` seconds of the plant's time
    /// after the last, and navigation's estimate.
    pub(crate) fn step(
        &mut self,
        now: Time,
        measurements: &Measurements,
        estimate: &Estimate,
        dt_s: f64,
    ) {
        if self.after_s <= 0.0 || dt_s <= 0.0 {
            return;
        }
        let attitude = measurements.attitude;
        let heading = measurements.heading_rad;
        let angles = [
            attitude.value.roll_rad,
            attitude.value.pitch_rad,
            heading.value,
        ];
        let before = self.before.replace(angles).unwrap_or(angles);
        let said = angle_rates(measurements, angles);

        self.step_angles(attitude.taken, heading.taken, angles, said, dt_s);
        self.step_rates(measurements, angles, before, said, dt_s);
        self.step_altitude(now, measurements, estimate, dt_s);

        let force = measurements.specific_force;
        let forces = [force.value.x_mps2, force.value.y_mps2, force.value.z_mps2];
        if self
            .force
            .has_changed(forces, SAME_FORCE_MPS2, force.taken, dt_s)
        {
            self.force_at = angles;
        }
        self.force
            .update(manoeuvred(self.force_at, angles), self.after_s);
        let airspeed = measurements.airspeed_mps;
        if self
            .airspeed
            .has_changed([airspeed.value], EXACTLY, airspeed.taken, dt_s)
        {
            self.airspeed_at = angles;
        }
        self.airspeed
            .update(manoeuvred(self.airspeed_at, angles), self.after_s);
    }

    fn step_angles(
        &mut self,
        attitude_taken: Time,
        heading_taken: Time,
        [roll, pitch, heading]: Angles,
        said: Angles,
        dt_s: f64,
    ) {
        let stuck = [&mut self.roll, &mut self.pitch, &mut self.heading];
        let values = [roll, pitch, heading];
        let taken = [attitude_taken, attitude_taken, heading_taken];
        for ((((stuck, turned), value), taken), rate) in stuck
            .into_iter()
            .zip(&mut self.turned)
            .zip(values)
            .zip(taken)
            .zip(said)
        {
            if stuck.has_changed([value], EXACTLY, taken, dt_s) {
                *turned = LeakyIntegrator::default();
            } else {
                turned.add(rate * dt_s, dt_s);
            }
            stuck.update(turned.exceeds(TURNED_RAD), self.after_s);
        }
    }

    fn step_rates(
        &mut self,
        measurements: &Measurements,
        angles: Angles,
        before: Angles,
        said: Angles,
        dt_s: f64,
    ) {
        let rates = measurements.body_rates;
        let values = [
            rates.value.roll_radps,
            rates.value.pitch_radps,
            rates.value.yaw_radps,
        ];
        if self.rates.has_changed(values, EXACTLY, rates.taken, dt_s) {
            self.unsaid = [LeakyIntegrator::default(); 3];
            return;
        }
        let mut exceeds = false;
        for (((unsaid, is), was), said) in self.unsaid.iter_mut().zip(angles).zip(before).zip(said)
        {
            unsaid.add(wrap_pi(is - was) - said * dt_s, dt_s);
            exceeds |= unsaid.exceeds(TURNED_RAD);
        }
        self.rates.update(exceeds, self.after_s);
    }

    fn step_altitude(
        &mut self,
        now: Time,
        measurements: &Measurements,
        estimate: &Estimate,
        dt_s: f64,
    ) {
        let altitude = measurements.altitude_m;
        let by_pitch_mps = estimate.true_airspeed_mps * sin(estimate.pitch_rad);
        if self
            .altitude
            .has_changed([altitude.value], EXACTLY, altitude.taken, dt_s)
        {
            self.climbed = LeakyIntegrator::default();
            self.climb_at_level_mps = estimate.climb_rate_mps - by_pitch_mps;
            return;
        }
        let climb_mps = match measurements.velocity.fresh(now, CURRENT) {
            Some(velocity) => -velocity.down_mps,
            None => self.climb_at_level_mps + by_pitch_mps,
        };
        self.climbed.add(climb_mps * dt_s, dt_s);
        self.altitude
            .update(self.climbed.exceeds(CLIMBED_M), self.after_s);
    }

    /// Which quantities are frozen.
    pub(crate) const fn frozen(&self) -> Frozen {
        Frozen {
            attitude: self.roll.is_frozen || self.pitch.is_frozen,
            heading: self.heading.is_frozen,
            body_rates: self.rates.is_frozen,
            specific_force: self.force.is_frozen,
            airspeed: self.airspeed.is_frozen,
            altitude: self.altitude.is_frozen,
        }
    }
}

/// Rates of roll, pitch and heading from the gyroscopes (Stevens, Lewis and
/// Johnson 2016, equation 1.4-4).
fn angle_rates(measurements: &Measurements, [roll, pitch, _]: Angles) -> Angles {
    let r = measurements.body_rates.value;
    let (sin_roll, cos_roll) = (sin(roll), cos(roll));
    let horizontal =
        (r.pitch_radps * sin_roll + r.yaw_radps * cos_roll) / cos(pitch).max(MIN_COS_PITCH);
    [
        r.roll_radps + sin(pitch) * horizontal,
        r.pitch_radps * cos_roll - r.yaw_radps * sin_roll,
        horizontal,
    ]
}

/// Whether bank or pitch changed so much that load and drag did.
fn manoeuvred([roll_was, pitch_was, _]: Angles, [roll, pitch, _]: Angles) -> bool {
    wrap_pi(roll - roll_was).abs() > BANKED_RAD || (pitch - pitch_was).abs() > PITCHED_RAD
}

#[cfg(test)]
mod tests;
