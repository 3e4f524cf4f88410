//! Pitch, roll and heading from gyroscopes and from direct measurements.

use core::time::Duration;

use libm::{cos, sin};

use super::resolution::Resolution;
use super::{NewSample, SampleTracker, is_current};
use crate::blocks::{Complementary, wrap_pi};
use crate::flight::Measurements;
use crate::framework::Time;

/// Pitch, roll and heading; the heading is continuous through full turns.
#[derive(Clone, Copy, Debug, Default)]
pub struct Orientation {
    /// Right wing down, rad.
    pub roll_rad: f64,
    /// Nose up, rad.
    pub pitch_rad: f64,
    /// Clockwise from north, rad, unbounded.
    pub heading_rad: f64,
}

/// Complementary filter over Euler angles (body rates converted to angle rates
/// as in Stevens, Lewis and Johnson 2016, equation 1.4-4).
///
/// ```
/// use fcc_core::flight::navigation::AttitudeChannel;
/// use fcc_core::flight::{BodyRates, Measurements};
/// use fcc_core::framework::{Reading, Time};
///
/// let mut channel = AttitudeChannel::new(1.36, 1.44);
/// // A standard rate turn, 3 °/s for 10 s, by the gyroscope alone.
/// let yaw_radps = 3.0_f64.to_radians();
/// let mut turned_rad = 0.0;
/// for n in 1..=400 {
///     let now = Time::from_nanos(n * 25_000_000);
///     let rates = BodyRates { yaw_radps, ..BodyRates::default() };
///     let measured = Measurements {
///         body_rates: Reading::new(rates, now),
///         ..Measurements::default()
///     };
///     turned_rad = channel.step(now, &measured, 0.025).heading_rad;
/// }
/// assert!((turned_rad.to_degrees() - 30.0).abs() < 1e-6);
/// ```
#[derive(Clone, Debug)]
pub struct AttitudeChannel {
    roll: Complementary,
    pitch: Complementary,
    heading: Complementary,
    attitude_news: SampleTracker,
    heading_news: SampleTracker,
    heading_resolution: Resolution,
}

/// The coarsest heading that is flown: 2°, rad.
const COARSEST_HEADING_RAD: f64 = 0.035;

/// Near the vertical the heading is undefined; the rates are not divided by
/// less than this cosine (about 80°).
pub(super) const MIN_COS_PITCH: f64 = 0.17;

impl AttitudeChannel {
    /// Time constants in s: of pitch and roll, of the heading.
    pub const fn new(attitude_tau_s: f64, heading_tau_s: f64) -> Self {
        Self {
            roll: Complementary::new(attitude_tau_s),
            pitch: Complementary::new(attitude_tau_s),
            heading: Complementary::new(heading_tau_s),
            attitude_news: SampleTracker::new(),
            heading_news: SampleTracker::new(),
            heading_resolution: Resolution::new(COARSEST_HEADING_RAD),
        }
    }

    /// What is known of the resolution of the heading's sensor.
    pub(super) const fn heading_resolution(&self) -> &Resolution {
        &self.heading_resolution
    }

    /// The sensor is the same as that of `other`.
    pub(super) const fn keep_resolution(&mut self, other: &Self) {
        self.heading_resolution = other.heading_resolution;
    }

    pub(super) fn postpone(&mut self, by: Duration, latest: Time) {
        self.attitude_news.postpone(by, latest);
        self.heading_news.postpone(by, latest);
    }

    pub(super) const fn adopt_next(&mut self) {
        self.attitude_news.adopts_next = true;
        self.heading_news.adopts_next = true;
    }

    /// Processes the measurements; returns the orientation.
    pub fn step(&mut self, now: Time, measurements: &Measurements, dt_s: f64) -> Orientation {
        if is_current(&measurements.body_rates, now) {
            let rates = measurements.body_rates.value;
            let (sin_roll, cos_roll) = (sin(self.roll.value()), cos(self.roll.value()));
            let (sin_pitch, cos_pitch) = (sin(self.pitch.value()), cos(self.pitch.value()));
            let horizontal = (rates.pitch_radps * sin_roll + rates.yaw_radps * cos_roll)
                / cos_pitch.max(MIN_COS_PITCH);
            self.roll
                .predict(rates.roll_radps + sin_pitch * horizontal, dt_s);
            self.pitch.predict(
                rates.pitch_radps * cos_roll - rates.yaw_radps * sin_roll,
                dt_s,
            );
            self.heading.predict(horizontal, dt_s);
        }
        let attitude = measurements.attitude;
        match self.attitude_news.of(&attitude, dt_s) {
            NewSample::None => {}
            NewSample::First => {
                self.roll.reset(attitude.value.roll_rad);
                self.pitch.reset(attitude.value.pitch_rad);
            }
            NewSample::Next(since_s) => {
                let roll_error = wrap_pi(attitude.value.roll_rad - self.roll.value());
                self.roll.correct_by(roll_error, since_s);
                self.pitch.correct(attitude.value.pitch_rad, since_s);
            }
        }
        let heading = measurements.heading_rad;
        let sample = self.heading_news.of(&heading, dt_s);
        if !matches!(sample, NewSample::None) {
            self.heading_resolution
                .take(&heading, |is, was| wrap_pi(is - was));
        }
        let error = wrap_pi(heading.value - self.heading.value());
        match sample {
            NewSample::None => {}
            // Continue the present count of full turns.
            NewSample::First => self.heading.reset(self.heading.value() + error),
            NewSample::Next(since_s) => {
                let beyond = self.heading_resolution.beyond(error);
                self.heading.correct_by(beyond, since_s);
            }
        }
        Orientation {
            roll_rad: wrap_pi(self.roll.value()),
            pitch_rad: self.pitch.value(),
            heading_rad: self.heading.value(),
        }
    }
}
