//! The first half second: where down is, and how sure that is.

use nalgebra::{UnitQuaternion, Vector3};

use super::filter::Filter;
use super::inputs::Step;
use super::motion::turn;
use super::parameters as p;
use super::states::{
    ATTITUDE, FORCE_BIAS, LATENESS, POSITION, RATE_BIAS, UNKNOWN_ANGLE, VELOCITY, WIND,
};
use fcc_core::units::GRAVITY_MPS2;

/// How long forces are averaged, s.
const DURATION_S: f64 = 0.5;
/// The least uncertainty of the horizon, rad: the bias of an accelerometer.
const LEAST_TILT: f64 = 0.02;
/// The largest, rad.
const LARGEST_TILT: f64 = 1.0;
/// A specific force that differs by this share from gravity is that of an
/// inaccurate sensor, and not of a turn.
const INACCURATE: f64 = 0.03;
/// Of a place of which nothing is known, m.
const UNKNOWN_PLACE_M: f64 = 1.0;

/// Sums of forces and of the magnetic field in the axes that the body had at the
/// first sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alignment {
    /// From the body's axes to those of the first sample.
    turned: UnitQuaternion<f64>,
    force: Vector3<f64>,
    force_squared: f64,
    forces: f64,
    field: Vector3<f64>,
    fields: f64,
    elapsed_s: f64,
}

impl Alignment {
    pub(super) fn new() -> Self {
        Self {
            turned: UnitQuaternion::identity(),
            force: Vector3::zeros(),
            force_squared: 0.0,
            forces: 0.0,
            field: Vector3::zeros(),
            fields: 0.0,
            elapsed_s: 0.0,
        }
    }

    pub(super) fn step(&mut self, step: &Step) {
        self.elapsed_s += step.dt_s;
        if let Some(rates) = step.reading.rates {
            self.turned *= turn(rates * step.dt_s);
        }
        if let Some(force) = step.reading.force {
            self.force += self.turned * force;
            self.force_squared += force.norm_squared();
            self.forces += 1.0;
        }
    }

    pub(super) fn add_field(&mut self, field: [f64; 3]) {
        self.field += self.turned * Vector3::from(field);
        self.fields += 1.0;
    }

    pub(super) fn is_complete(&self) -> bool {
        self.elapsed_s >= DURATION_S
    }

    /// The attitude so far: the magnetic field, if there is one, points north.
    pub(super) fn provisional(&self) -> (UnitQuaternion<f64>, f64) {
        let (attitude, tilt) = self.attitude();
        let field = attitude * (self.turned.inverse() * self.field);
        if field.xy().norm() > 0.0 {
            let north = turn(Vector3::new(0.0, 0.0, -libm::atan2(field.y, field.x)));
            return (north * attitude, tilt);
        }
        (attitude, tilt)
    }

    /// Attitude with an arbitrary heading, from what there is so far, and the
    /// standard deviation of the horizon, rad.
    fn attitude(&self) -> (UnitQuaternion<f64>, f64) {
        let down = self.turned.inverse() * -self.force;
        if self.forces < 1.0 || down.norm() <= 0.0 {
            return (UnitQuaternion::identity(), LARGEST_TILT);
        }
        let attitude =
            UnitQuaternion::rotation_between(&down, &Vector3::z()).unwrap_or_else(|| {
                UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0))
            });
        let mean = self.force.norm() / self.forces;
        let scatter = libm::sqrt((self.force_squared / self.forces - mean * mean).max(0.0));
        // An acceleration across gravity makes the force larger by its square.
        let excess = libm::fabs(mean / GRAVITY_MPS2 - 1.0) - INACCURATE;
        let turning = libm::sqrt(2.0 * excess.max(0.0));
        let tilt = LEAST_TILT + 0.5 * scatter / GRAVITY_MPS2 + turning;
        (attitude, tilt.min(LARGEST_TILT))
    }

    /// Starts the filter. The mean magnetic field in body axes, if there is one.
    pub(super) fn finish(&self, filter: &mut Filter) -> Option<[f64; 3]> {
        let (attitude, tilt) = self.attitude();
        filter.motion.attitude = attitude;
        filter.reset_covariance(ATTITUDE, 2, tilt * tilt);
        filter.reset_covariance(ATTITUDE + 2, 1, UNKNOWN_ANGLE);
        filter.reset_covariance(VELOCITY, 3, p::HAND_VELOCITY * p::HAND_VELOCITY);
        filter.reset_covariance(POSITION, 2, UNKNOWN_PLACE_M);
        filter.reset_covariance(RATE_BIAS, 3, p::RATE_BIAS * p::RATE_BIAS);
        filter.reset_covariance(FORCE_BIAS, 3, p::FORCE_BIAS * p::FORCE_BIAS);
        filter.reset_covariance(WIND, 2, p::WIND * p::WIND);
        filter.reset_covariance(LATENESS, 1, p::LATENESS * p::LATENESS);
        (self.fields > 0.0).then(|| (self.turned.inverse() * (self.field / self.fields)).into())
    }
}
