//! Indicated airspeed from the airspeed sensor and the accelerometers.

use core::time::Duration;

use libm::{asin, cos, sin};

use super::attitude::Orientation;
use super::force_sample::MIN_AIRSPEED_MPS;
use super::resolution::Resolution;
use super::sample_tracker::{NewSample, SampleTracker, is_current};
use super::vertical::VerticalState;
use fcc_core::blocks::{Complementary, limit_abs};
use fcc_core::flight::Measurements;
use fcc_core::framework::Time;
use fcc_core::units::GRAVITY_MPS2;

/// Complementary filter: the acceleration along the flight path over short
/// times, the airspeed sensor over long times. So a gust that does not
/// accelerate the aircraft does not count as a change of speed.
///
/// ```
/// use fcc_core::flight::Measurements;
/// use fcc_navigation::{AirspeedChannel, AttitudeChannel, VerticalChannel};
/// use fcc_core::framework::{Reading, Time};
///
/// let now = Time::from_nanos(25_000_000);
/// let measured = Measurements {
///     airspeed_mps: Reading::new(51.4, now),
///     ..Measurements::default()
/// };
/// let level = AttitudeChannel::new(1.36, 1.44).step(now, &measured, 0.025);
/// let vertical = VerticalChannel::new(0.68).step(now, &measured, &level, 0.025);
/// let mut airspeed = AirspeedChannel::new(0.89);
/// assert_eq!(airspeed.step(now, &measured, &level, &vertical, 1.0, 0.025), 51.4);
/// ```
#[derive(Clone, Debug)]
pub struct AirspeedChannel {
    airspeed: Complementary,
    news: SampleTracker,
    resolution: Resolution,
    /// The acceleration that was integrated last, of the indicated airspeed, m/s².
    felt_mps2: f64,
}

/// The coarsest airspeed sensor that is flown: 2 kt, m/s.
const COARSEST_MPS: f64 = 1.03;

/// The largest angle of attack in normal flight, rad.
const MAX_ALPHA_RAD: f64 = 0.3;

impl AirspeedChannel {
    /// Time constant in s.
    pub const fn new(tau_s: f64) -> Self {
        Self {
            airspeed: Complementary::new(tau_s),
            news: SampleTracker::new(),
            resolution: Resolution::new(COARSEST_MPS),
            felt_mps2: 0.0,
        }
    }

    /// What is known of the sensor's resolution.
    pub(super) const fn resolution(&self) -> &Resolution {
        &self.resolution
    }

    /// The acceleration along the flight path by the accelerometers, of the
    /// indicated airspeed, m/s².
    pub(super) const fn felt_mps2(&self) -> f64 {
        self.felt_mps2
    }

    /// The sensor is the same as that of `other`.
    pub(super) const fn keep_resolution(&mut self, other: &Self) {
        self.resolution = other.resolution;
    }

    pub(super) fn postpone(&mut self, by: Duration, latest: Time) {
        self.news.postpone(by, latest);
    }

    pub(super) const fn adopt_next(&mut self) {
        self.news.adopts_next = true;
    }

    /// Processes the measurements; returns indicated airspeed in m/s.
    /// `sqrt_density` is the root of
    /// [`density_ratio`](fcc_core::flight::atmosphere::density_ratio) at the altitude.
    pub fn step(
        &mut self,
        now: Time,
        measurements: &Measurements,
        orientation: &Orientation,
        vertical: &VerticalState,
        sqrt_density: f64,
        dt_s: f64,
    ) -> f64 {
        if is_current(&measurements.specific_force, now) {
            let force = measurements.specific_force.value;
            let true_airspeed = (self.airspeed.value() / sqrt_density).max(MIN_AIRSPEED_MPS);
            let sin_path = limit_abs(vertical.climb_rate_mps / true_airspeed, 1.0);
            // Angle of attack, assuming still air.
            let alpha = limit_abs(orientation.pitch_rad - asin(sin_path), MAX_ALPHA_RAD);
            let along_path = force.x_mps2 * cos(alpha) + force.z_mps2 * sin(alpha);
            self.felt_mps2 = (along_path - GRAVITY_MPS2 * sin_path) * sqrt_density;
            self.airspeed.predict(self.felt_mps2, dt_s);
        } else {
            self.felt_mps2 = 0.0;
        }
        let measured = measurements.airspeed_mps;
        match self.news.of(&measured, dt_s) {
            NewSample::None => {}
            NewSample::First => {
                self.resolution.take(&measured, |is, was| is - was);
                self.airspeed.reset(measured.value);
            }
            NewSample::Next(since_s) => {
                self.resolution.take(&measured, |is, was| is - was);
                let error = measured.value - self.airspeed.value();
                let beyond = self.resolution.beyond(error);
                self.airspeed.correct_by(beyond, since_s);
            }
        }
        self.airspeed.value()
    }
}
