//! Detects sensors whose readings are frozen while the aircraft moves.
//!
//! A sensor that hangs often keeps sending its last value with new times. An
//! unchanged value alone is no proof: in calm air a good sensor with coarse
//! resolution may give the same value for long. So a quantity is frozen when
//! its bits have stayed the same for some time *and* other quantities show a
//! motion by which it must have changed: the gyroscopes for the attitude and
//! the heading, attitude and heading for the gyroscopes, a change of bank or pitch for
//! airspeed and accelerometers, and for the airspeed an acceleration along the path or
//! a gust, too. While nothing moves, a frozen sensor is not detected, and has no effect.
//! An altimeter that stands is one that differs (`altitude_monitor`).
//!
//! The motion counts from the last change on, and must exceed the resolution of
//! the sensor as well, which is the smallest change that it has ever shown. Of a
//! coarse airspeed sensor a manoeuvre shows nothing, since an airspeed that is
//! held stays within its step: what counts is the acceleration.
//!
//! The motion shown by other quantities is integrated with a leak, so that
//! their small errors never add up to a motion. A sensor with any noise never
//! repeats its bits, so that it cannot be reported by mistake.

mod evidence;

use libm::{cos, sin};

use super::attitude::MIN_COS_PITCH;
use evidence::{LeakyIntegrator, StuckDetector};

use super::quantity::{Quantities, Quantity};
use super::resolution::Resolutions;
use fcc_core::blocks::wrap_pi;
use fcc_core::flight::{BodyRates, Measurements};
use fcc_core::framework::Time;

/// The rotation that attitude, heading or gyroscopes must show, rad (5°): ten
/// times the resolution of a coarse attitude sensor.
const TURNED_RAD: f64 = 0.087;
/// Changes of bank and pitch that change load and drag, rad (10°, 4°): well
/// beyond those of a trimmed aircraft in calm air.
const BANKED_RAD: f64 = 0.175;
const PITCHED_RAD: f64 = 0.07;
/// Steps of a fine airspeed sensor, m/s: a tenth of 0.1 kt, within which the airspeed of an
/// aircraft that banks or pitches in calm air may stay.
const FINE_AIRSPEED_MPS: f64 = 0.005;
/// The change of airspeed that a coarse sensor must show, m/s: an error of the
/// accelerations by 0.75 m/s² (4° of pitch) never reaches it.
const ACCELERATED_MPS: f64 = 7.5;
/// A vertical acceleration that a fine airspeed sensor must show, m/s²: a gust that
/// changes the lift by a fifth has a part along the path, and changes the drag.
const GUST_MPS2: f64 = 2.0;
/// Unchanged means the same to the last bit, ...
const EXACTLY: f64 = 0.0;
/// ... except for a specific force computed from an acceleration over the
/// ground, which involves rounding, m/s²: a tenth of the noise of the best
/// small accelerometers.
const SAME_FORCE_MPS2: f64 = 1e-3;

/// What navigation knows that the evidence needs.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// The acceleration along the flight path, of the indicated airspeed, m/s².
    pub felt_mps2: f64,
    /// The vertical acceleration, up, m/s².
    pub felt_up_mps2: f64,
    /// The steps in which the sensors give their values.
    pub resolutions: Resolutions,
    /// The learned bias of the gyroscopes, about x, y and z, rad/s.
    pub rate_bias_radps: [f64; 3],
}

/// Roll, pitch and heading, rad, or their rates.
type Angles = [f64; 3];

/// Monitors the quantities needed by control, but the altitude.
#[derive(Clone, Debug)]
pub struct FrozenDetector {
    /// 0 switches the check off.
    after_s: f64,
    roll: StuckDetector<1>,
    pitch: StuckDetector<1>,
    heading: StuckDetector<1>,
    rates: [StuckDetector<1>; 3],
    force: StuckDetector<3>,
    airspeed: StuckDetector<1>,
    /// Rotation by the gyroscopes since roll, pitch and heading changed.
    turned: [LeakyIntegrator; 3],
    /// Rotation by attitude and heading minus that by the gyroscopes, since the
    /// gyroscope of that axis changed.
    unsaid: [LeakyIntegrator; 3],
    /// The attitude when specific force and airspeed changed.
    force_at: Angles,
    airspeed_at: Angles,
    /// The change of airspeed by the accelerometers since it changed.
    accelerated: LeakyIntegrator,
    /// The largest vertical acceleration since it changed, m/s².
    gust_mps2: f64,
    /// The measured attitude and heading of the previous tick.
    before: Option<Angles>,
}

impl FrozenDetector {
    /// A value must have been unchanged for `after_s` of the plant's time; 0
    /// switches the check off.
    pub const fn new(after_s: f64) -> Self {
        Self {
            after_s,
            roll: StuckDetector::new([0.0], Time::NEVER),
            pitch: StuckDetector::new([0.0], Time::NEVER),
            heading: StuckDetector::new([0.0], Time::NEVER),
            rates: [StuckDetector::new([0.0], Time::NEVER); 3],
            force: StuckDetector::new([0.0; 3], Time::NEVER),
            airspeed: StuckDetector::new([0.0], Time::NEVER),
            turned: [LeakyIntegrator::ZERO; 3],
            unsaid: [LeakyIntegrator::ZERO; 3],
            force_at: [0.0; 3],
            airspeed_at: [0.0; 3],
            accelerated: LeakyIntegrator::ZERO,
            gust_mps2: 0.0,
            before: None,
        }
    }

    /// Processes the measurements `dt_s` seconds of the plant's time after the last, and what
    /// navigation knows.
    pub fn step(&mut self, measurements: &Measurements, navigation: &Known, dt_s: f64) {
        let resolutions = &navigation.resolutions;
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
        let said = angle_rates(measurements, navigation.rate_bias_radps, angles);

        let steps = [0.0, 0.0, resolutions.heading_rad];
        self.step_angles(attitude.taken, heading.taken, angles, said, steps, dt_s);
        self.step_rates(measurements, angles, before, said, dt_s);
        self.step_airspeed(measurements, angles, navigation, dt_s);

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
    }

    fn step_airspeed(
        &mut self,
        measurements: &Measurements,
        angles: Angles,
        navigation: &Known,
        dt_s: f64,
    ) {
        let airspeed = measurements.airspeed_mps;
        let resolution = navigation.resolutions.airspeed_mps;
        if self
            .airspeed
            .has_changed([airspeed.value], EXACTLY, airspeed.taken, dt_s)
        {
            self.airspeed_at = angles;
            self.accelerated = LeakyIntegrator::default();
            self.gust_mps2 = 0.0;
        } else {
            self.gust_mps2 = self.gust_mps2.max(navigation.felt_up_mps2.abs());
            let gained_mps = navigation.felt_mps2 * dt_s;
            self.accelerated
                .add(gained_mps, ACCELERATED_MPS, resolution, dt_s);
        }
        let must_have_changed = self.accelerated.exceeds(ACCELERATED_MPS, resolution)
            || resolution < FINE_AIRSPEED_MPS
                && (manoeuvred(self.airspeed_at, angles) || self.gust_mps2 > GUST_MPS2);
        self.airspeed.update(must_have_changed, self.after_s);
    }

    fn step_angles(
        &mut self,
        attitude_taken: Time,
        heading_taken: Time,
        [roll, pitch, heading]: Angles,
        said: Angles,
        resolutions: Angles,
        dt_s: f64,
    ) {
        let stuck = [&mut self.roll, &mut self.pitch, &mut self.heading];
        let values = [roll, pitch, heading];
        let taken = [attitude_taken, attitude_taken, heading_taken];
        for (((((stuck, turned), value), taken), rate), resolution) in stuck
            .into_iter()
            .zip(&mut self.turned)
            .zip(values)
            .zip(taken)
            .zip(said)
            .zip(resolutions)
        {
            if stuck.has_changed([value], EXACTLY, taken, dt_s) {
                *turned = LeakyIntegrator::default();
            } else {
                turned.add(rate * dt_s, TURNED_RAD, resolution, dt_s);
            }
            stuck.update(turned.exceeds(TURNED_RAD, resolution), self.after_s);
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
        // Of angles that stand still nothing follows.
        let is_said = !(self.roll.is_frozen || self.pitch.is_frozen || self.heading.is_frozen);
        let stuck = self.rates.iter_mut().zip(&mut self.unsaid).zip(values);
        let turned = angles.into_iter().zip(before).zip(said);
        for (((stuck, unsaid), value), ((is, was), said)) in stuck.zip(turned) {
            if stuck.has_changed([value], EXACTLY, rates.taken, dt_s) || !is_said {
                *unsaid = LeakyIntegrator::default();
            } else {
                unsaid.add(wrap_pi(is - was) - said * dt_s, TURNED_RAD, 0.0, dt_s);
            }
        }
        let mut unsaid = self.unsaid.iter();
        let exceeds = unsaid.any(|unsaid| unsaid.exceeds(TURNED_RAD, 0.0));
        for stuck in &mut self.rates {
            stuck.update(exceeds, self.after_s);
        }
    }

    /// Which quantities are frozen.
    pub const fn frozen(&self) -> Quantities {
        let [roll, pitch, yaw] = &self.rates;
        let rates = roll.is_frozen || pitch.is_frozen || yaw.is_frozen;
        Quantities::NONE
            .with(
                Quantity::Attitude,
                self.roll.is_frozen || self.pitch.is_frozen,
            )
            .with(Quantity::Heading, self.heading.is_frozen)
            .with(Quantity::BodyRates, rates)
            .with(Quantity::SpecificForce, self.force.is_frozen)
            .with(Quantity::Airspeed, self.airspeed.is_frozen)
    }
}

/// Rates of roll, pitch and heading from the gyroscopes (Stevens, Lewis and
/// Johnson 2016, equation 1.4-4).
fn angle_rates(measurements: &Measurements, bias: Angles, [roll, pitch, _]: Angles) -> Angles {
    let rates = measurements.body_rates.value;
    let [x, y, z] = bias;
    let r = BodyRates {
        roll_radps: rates.roll_radps - x,
        pitch_radps: rates.pitch_radps - y,
        yaw_radps: rates.yaw_radps - z,
    };
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
