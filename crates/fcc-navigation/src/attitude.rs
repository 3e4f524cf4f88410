//! Pitch, roll and heading from gyroscopes and from direct measurements.

use core::time::Duration;

use libm::{atan2, cos, sin, sqrt};

use super::resolution::Resolution;
use super::sample_tracker::{NewSample, SampleTracker, is_current};
use fcc_core::blocks::{smoothing_factor, wrap_pi};
use fcc_core::flight::orientation::{
    EulerAngles, earth_to_body, euler_from_quaternion, product, quaternion_from_euler,
};
use fcc_core::flight::{BodyRates, Measurements};
use fcc_core::framework::Time;

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

/// Complementary filter over rotations, right in every attitude (as Mahony et al.
/// 2008): the gyroscopes turn the attitude; measured pitch and roll correct the
/// direction of gravity in body axes, and the measured heading corrects the
/// rotation about it.
///
/// Euler angles are what it takes and gives; with the nose within 10° of the
/// vertical, where heading and roll are one rotation, the measured heading is not
/// used.
///
/// ```
/// use fcc_navigation::AttitudeChannel;
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
    attitude_tau_s: f64,
    heading_tau_s: f64,
    /// From body axes to earth axes.
    rotation: [f64; 4],
    /// Its heading, rad, continuous through full turns.
    heading_rad: f64,
    attitude_news: SampleTracker,
    heading_news: SampleTracker,
    heading_resolution: Resolution,
}

/// The coarsest heading that is flown: 2°, rad.
const COARSEST_HEADING_RAD: f64 = 0.035;

/// Near the vertical the heading is undefined: below this cosine of the pitch
/// (about 80°).
pub(super) const MIN_COS_PITCH: f64 = 0.17;

impl AttitudeChannel {
    /// Time constants in s: of pitch and roll, of the heading.
    pub const fn new(attitude_tau_s: f64, heading_tau_s: f64) -> Self {
        Self {
            attitude_tau_s,
            heading_tau_s,
            rotation: [1.0, 0.0, 0.0, 0.0],
            heading_rad: 0.0,
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

    /// Adopts roll and pitch of a rotation, and keeps the heading.
    pub(super) fn adopt_gravity(&mut self, rotation: [f64; 4]) {
        self.rotation = quaternion_from_euler(EulerAngles {
            heading_rad: euler_from_quaternion(self.rotation).heading_rad,
            ..euler_from_quaternion(rotation)
        });
    }

    /// Counts full turns so that the heading is the nearest to `near_rad`;
    /// returns it.
    pub(super) fn count_near(&mut self, near_rad: f64) -> f64 {
        self.heading_rad = near_rad + wrap_pi(self.heading_rad - near_rad);
        self.heading_rad
    }

    /// Processes the measurements; returns the orientation.
    pub fn step(&mut self, now: Time, measurements: &Measurements, dt_s: f64) -> Orientation {
        if is_current(&measurements.body_rates, now) {
            let rates = measurements.body_rates.value;
            self.rotation = product(self.rotation, turn(&rates, dt_s));
        }
        let measured = measurements.attitude.value;
        let measured = EulerAngles {
            roll_rad: measured.roll_rad,
            pitch_rad: measured.pitch_rad,
            heading_rad: self.heading_rad,
        };
        match self.attitude_news.of(&measurements.attitude, dt_s) {
            NewSample::None => {}
            NewSample::First => self.rotation = quaternion_from_euler(measured),
            NewSample::Next(since_s) => {
                let share = smoothing_factor(since_s, self.attitude_tau_s);
                self.correct_gravity(measured, share);
            }
        }
        let heading = measurements.heading_rad;
        let sample = self.heading_news.of(&heading, dt_s);
        if !matches!(sample, NewSample::None) {
            self.heading_resolution
                .take(&heading, |is, was| wrap_pi(is - was));
        }
        let mut angles = euler_from_quaternion(self.rotation);
        let error = wrap_pi(heading.value - angles.heading_rad);
        let correction = match sample {
            NewSample::None => 0.0,
            NewSample::First => error,
            NewSample::Next(since_s) => {
                smoothing_factor(since_s, self.heading_tau_s)
                    * self.heading_resolution.beyond(error)
            }
        };
        if correction != 0.0 && cos(angles.pitch_rad) >= MIN_COS_PITCH {
            angles.heading_rad += correction;
            self.rotation = quaternion_from_euler(angles);
        }
        self.heading_rad += wrap_pi(angles.heading_rad - self.heading_rad);
        Orientation {
            roll_rad: angles.roll_rad,
            pitch_rad: angles.pitch_rad,
            heading_rad: self.heading_rad,
        }
    }

    /// Turns by a `share` of what brings gravity to its measured direction, on
    /// the shortest way.
    fn correct_gravity(&mut self, measured: EulerAngles, share: f64) {
        const DOWN: [f64; 3] = [0.0, 0.0, 1.0];
        let [ax, ay, az] = earth_to_body(quaternion_from_euler(measured), DOWN);
        let [bx, by, bz] = earth_to_body(self.rotation, DOWN);
        let axis = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
        let [x, y, z] = axis;
        let length = sqrt(x * x + y * y + z * z);
        if length > 0.0 {
            let angle = share * atan2(length, ax * bx + ay * by + az * bz);
            self.rotation = product(self.rotation, rotation_about(axis, length, angle));
        }
    }
}

/// The rotation of body rates in a time.
pub(super) fn turn(rates: &BodyRates, dt_s: f64) -> [f64; 4] {
    let axis = [rates.roll_radps, rates.pitch_radps, rates.yaw_radps];
    let [x, y, z] = axis;
    let rate = sqrt(x * x + y * y + z * z);
    if rate > 0.0 {
        rotation_about(axis, rate, rate * dt_s)
    } else {
        [1.0, 0.0, 0.0, 0.0]
    }
}

/// The rotation about an axis of a length.
pub(super) fn rotation_about([x, y, z]: [f64; 3], length: f64, angle_rad: f64) -> [f64; 4] {
    let share = sin(0.5 * angle_rad) / length;
    [cos(0.5 * angle_rad), share * x, share * y, share * z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_core::flight::Attitude;
    use fcc_core::framework::Reading;

    const DT_S: f64 = 0.025;

    /// Flies a rotation at constant body rates (°/s) for a time, with exact
    /// sensors; returns the largest angle between the estimated and the true
    /// direction of each body axis, in degrees.
    fn largest_error_deg(rates_degps: [f64; 3], seconds: f64) -> f64 {
        let [p, q, r] = rates_degps.map(f64::to_radians);
        let rates = BodyRates {
            roll_radps: p,
            pitch_radps: q,
            yaw_radps: r,
        };
        let start = quaternion_from_euler(EulerAngles {
            heading_rad: 1.0,
            ..EulerAngles::default()
        });
        let mut channel = AttitudeChannel::new(1.36, 1.44);
        let mut worst = 0.0_f64;
        for n in 0..(seconds / DT_S) as i64 {
            let passed_s = DT_S * n as f64;
            let truth = product(start, turn(&rates, passed_s));
            let angles = euler_from_quaternion(truth);
            let now = Time::from_nanos(25_000_000 * (n + 1));
            let attitude = Attitude {
                roll_rad: angles.roll_rad,
                pitch_rad: angles.pitch_rad,
            };
            let measured = Measurements {
                body_rates: Reading::new(rates, now),
                attitude: Reading::new(attitude, now),
                heading_rad: Reading::new(angles.heading_rad, now),
                ..Measurements::default()
            };
            let found = channel.step(now, &measured, DT_S);
            let found = quaternion_from_euler(EulerAngles {
                roll_rad: found.roll_rad,
                pitch_rad: found.pitch_rad,
                heading_rad: found.heading_rad,
            });
            let dot: f64 = truth.iter().zip(found).map(|(a, b)| a * b).sum();
            worst = worst.max(2.0 * dot.abs().min(1.0).acos().to_degrees());
        }
        worst
    }

    /// Loops, rolls, a spin with the nose down, and tumbles about all axes pass
    /// through the vertical and the inverted attitude.
    #[test]
    fn it_is_right_through_all_attitudes() {
        for rates in [
            [0.0, 47.0, 0.0],
            [120.0, 0.0, 0.0],
            [60.0, 20.0, 150.0],
            [30.0, 50.0, -20.0],
            [0.0, -80.0, 3.0],
        ] {
            let worst = largest_error_deg(rates, 20.0);
            assert!(worst < 0.1, "{rates:?}: {worst} deg");
        }
    }

    #[test]
    fn the_heading_is_counted_near_another() {
        let mut channel = AttitudeChannel::new(1.36, 1.44);
        channel.heading_rad = 14.0;
        let near = channel.count_near(1.0);
        assert!((near - (14.0 - 4.0 * core::f64::consts::PI)).abs() < 1e-12);
    }
}
