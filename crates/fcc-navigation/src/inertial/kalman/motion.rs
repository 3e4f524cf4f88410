//! Dead reckoning with gyroscopes and accelerometers: the part of the state that
//! moves by itself.

use libm::{cos, sin};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::inertial::GeodeticPosition;
use fcc_core::flight::earth::{gravity_mps2, metres_per_radian};

/// Where it is and how it moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// From body axes to north, east, down.
    pub(super) attitude: UnitQuaternion<f64>,
    /// North, east, down, m/s.
    pub(super) velocity: Vector3<f64>,
    /// While no receiver has given a position it is counted from 0° N, 0° E.
    pub(super) place: GeodeticPosition,
    /// Whether latitude and longitude are those of a receiver.
    pub(super) is_located: bool,
}

/// One reading of the inertial sensors as it came.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raw {
    pub(super) rates: Option<Vector3<f64>>,
    pub(super) force: Option<Vector3<f64>>,
}

/// One reading of the inertial sensors without their biases.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inertial {
    /// rad/s.
    pub(super) rates: Vector3<f64>,
    /// m/s²; `None` is unaccelerated motion.
    pub(super) force: Option<Vector3<f64>>,
}

/// What one step of dead reckoning has added.
#[derive(Clone, Copy, Debug)]
pub(super) struct Increment {
    /// The change of velocity by the specific force that was measured, which an error of
    /// the attitude turns: north, east, down, m/s.
    pub(super) velocity: Vector3<f64>,
    /// The acceleration over the ground, m/s².
    pub(super) acceleration: Vector3<f64>,
    /// The rotation in each half of the step.
    pub(super) half: UnitQuaternion<f64>,
}

impl Motion {
    pub(super) fn new() -> Self {
        Self {
            attitude: UnitQuaternion::identity(),
            velocity: Vector3::zeros(),
            place: GeodeticPosition {
                latitude_rad: 0.0,
                longitude_rad: 0.0,
                altitude_m: 0.0,
            },
            is_located: false,
        }
    }

    /// Moves on by `dt_s` with the reading at its end, which stands for the time
    /// since the one before: what inertial sensors give out is averaged, and at
    /// least as late as that.
    pub(super) fn advance(&mut self, reading: &Inertial, dt_s: f64) -> Increment {
        let gravity = self.gravity();
        let half = turn(0.5 * reading.rates * dt_s);
        let midway = self.attitude * half;
        self.attitude = midway * half;
        self.attitude.renormalize_fast();
        let measured = reading.force.map(|force| midway * force);
        let acceleration = measured.map_or(Vector3::zeros(), |force| force + gravity);
        let mean = self.velocity + 0.5 * acceleration * dt_s;
        self.velocity += acceleration * dt_s;
        self.shift(mean * dt_s);
        Increment {
            velocity: measured.unwrap_or_default() * dt_s,
            acceleration,
            half,
        }
    }

    /// Moves the place by metres north, east, down.
    pub(super) fn shift(&mut self, by: Vector3<f64>) {
        let (north, east) = self.metres_per_radian();
        self.place.latitude_rad += by.x / north;
        self.place.longitude_rad += by.y / east;
        self.place.altitude_m -= by.z;
    }

    /// From here to a place: north, east, down, m.
    pub(super) fn to_place(self, place: GeodeticPosition) -> Vector3<f64> {
        let (north, east) = self.metres_per_radian();
        Vector3::new(
            (place.latitude_rad - self.place.latitude_rad) * north,
            fcc_core::blocks::wrap_pi(place.longitude_rad - self.place.longitude_rad) * east,
            self.place.altitude_m - place.altitude_m,
        )
    }

    pub(super) fn gravity(&self) -> Vector3<f64> {
        let latitude_rad = if self.is_located {
            self.place.latitude_rad
        } else {
            f64::NAN
        };
        Vector3::new(0.0, 0.0, gravity_mps2(latitude_rad, self.place.altitude_m))
    }

    fn metres_per_radian(&self) -> (f64, f64) {
        metres_per_radian(self.place.latitude_rad, self.place.altitude_m)
    }
}

/// The rotation by a rotation vector, rad.
pub(in crate::inertial) fn turn(vector: Vector3<f64>) -> UnitQuaternion<f64> {
    let angle = vector.norm();
    // sin(x/2)/x, whose limit is 1/2.
    let factor = if angle > 1e-6 {
        sin(0.5 * angle) / angle
    } else {
        0.5 - angle * angle / 48.0
    };
    let imaginary = vector * factor;
    UnitQuaternion::new_normalize(Quaternion::new(
        cos(0.5 * angle),
        imaginary.x,
        imaginary.y,
        imaginary.z,
    ))
}
