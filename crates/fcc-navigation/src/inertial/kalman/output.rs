//! The estimate at the present.

use libm::{atan2, cos, hypot, sin, sqrt};
use nalgebra::{UnitQuaternion, Vector3};

use super::KalmanNavigation;
use super::filter::Filter;
use super::motion::Motion;
use super::states::{
    ATTITUDE, BAROMETER_BIAS, BODY_FIELD, EARTH_FIELD, FORCE_BIAS, LATENESS, POSITION, RATE_BIAS,
    VELOCITY, WIND,
};
use crate::inertial::{GeodeticPosition, Sigma, Solution};
use fcc_core::framework::Time;

impl KalmanNavigation {
    /// The filter's state, moved on to `now` with the inertial samples since.
    pub(super) fn solution(&self, now: Time) -> Solution {
        if let Some(alignment) = &self.alignment {
            let (attitude, tilt) = alignment.provisional();
            return Solution {
                time: now,
                quaternion: array(&attitude),
                sigma: Sigma {
                    roll_rad: tilt,
                    pitch_rad: tilt,
                    ..Sigma::UNKNOWN
                },
                ..Solution::UNKNOWN
            };
        }
        let filter = &self.filter;
        let motion = self.predicted(now);
        let mut displacement = motion.to_place(self.origin);
        displacement.neg_mut();
        Solution {
            time: now,
            quaternion: array(&motion.attitude),
            velocity_mps: motion.velocity.into(),
            position: if motion.is_located {
                motion.place
            } else {
                GeodeticPosition {
                    altitude_m: motion.place.altitude_m,
                    ..GeodeticPosition::UNKNOWN
                }
            },
            displacement_m: displacement.into(),
            gyroscope_bias_radps: filter.rate_bias.into(),
            accelerometer_bias_mps2: filter.force_bias.into(),
            barometer_bias_m: filter.barometer_bias,
            earth_field_ut: filter.earth_field.into(),
            body_field_ut: filter.body_field.into(),
            wind_mps: filter.wind.into(),
            fixes_late_s: filter.late_s,
            sigma: filter.sigmas(&motion.attitude),
        }
    }

    fn predicted(&self, now: Time) -> Motion {
        let mut motion = self.filter.motion;
        let mut inputs = self.inputs;
        let mut advance = |step: super::inputs::Step| {
            motion.advance(&self.filter.without_bias(&step.reading), step.dt_s);
        };
        for (at, sample) in self.history.after(0).enumerate() {
            if sample.taken > now {
                break;
            }
            if let Some(step) = inputs.take(sample, &self.history, at + 1) {
                advance(step);
            }
        }
        if let Some(step) = inputs.held(now) {
            advance(step);
        }
        motion
    }
}

impl Filter {
    /// Standard deviations; those of the angles at an attitude.
    fn sigmas(&self, attitude: &UnitQuaternion<f64>) -> Sigma {
        let [roll_rad, pitch_rad, heading_rad] = self.angle_sigmas(attitude);
        let three = |at| [at, at + 1, at + 2].map(|at| self.sigma(at));
        Sigma {
            roll_rad,
            pitch_rad,
            heading_rad,
            velocity_mps: three(VELOCITY),
            position_m: three(POSITION),
            gyroscope_bias_radps: three(RATE_BIAS),
            accelerometer_bias_mps2: three(FORCE_BIAS),
            barometer_bias_m: self.sigma(BAROMETER_BIAS),
            earth_field_ut: three(EARTH_FIELD),
            body_field_ut: three(BODY_FIELD),
            wind_mps: [WIND, WIND + 1].map(|at| self.sigma(at)),
            fixes_late_s: self.sigma(LATENESS),
        }
    }

    /// Of roll, pitch and heading, from those of a rotation in earth axes (the
    /// inverse of Stevens, Lewis and Johnson 2016, equation 1.4-3, in the axes
    /// of the heading). Near the vertical, roll and heading are uncertain.
    fn angle_sigmas(&self, attitude: &UnitQuaternion<f64>) -> [f64; 3] {
        /// 89°.
        const LEAST_COSINE: f64 = 0.0175;
        let nose = attitude * Vector3::x();
        let heading = atan2(nose.y, nose.x);
        let level = hypot(nose.x, nose.y).max(LEAST_COSINE);
        let tangent = -nose.z / level;
        let (along_n, along_e) = (cos(heading), sin(heading));
        let covariance = self.covariance.fixed_view::<3, 3>(ATTITUDE, ATTITUDE);
        [
            Vector3::new(along_n / level, along_e / level, 0.0),
            Vector3::new(-along_e, along_n, 0.0),
            Vector3::new(along_n * tangent, along_e * tangent, 1.0),
        ]
        .map(|row| sqrt(row.dot(&(covariance * row)).max(0.0)))
    }
}

fn array(attitude: &UnitQuaternion<f64>) -> [f64; 4] {
    let q = attitude.quaternion();
    [q.w, q.i, q.j, q.k]
}
