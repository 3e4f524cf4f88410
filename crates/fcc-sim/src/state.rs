//! Position and motion of a rigid body, and of the air around it.

use nalgebra::{UnitQuaternion, Vector3};

/// Position and motion of a rigid body.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct State {
    /// North, east and down of the origin at mean sea level, m.
    pub position_m: Vector3<f64>,
    /// Over the ground, north-east-down, m/s.
    pub velocity_mps: Vector3<f64>,
    /// Turns body axes to north-east-down.
    pub attitude: UnitQuaternion<f64>,
    /// Turn rates P, Q, R about the body axes, rad/s.
    pub rates_radps: Vector3<f64>,
}

/// The motion of the air.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AirMotion {
    /// Steady wind: the velocity of the air, north-east-down, m/s.
    pub wind_mps: Vector3<f64>,
    /// Gust in addition to the wind, body axes, m/s.
    pub gust_mps: Vector3<f64>,
    /// Turn rate of the air over the aircraft's length and span, rad/s.
    pub gust_rates_radps: Vector3<f64>,
}

impl AirMotion {
    /// Air at rest.
    pub const CALM: Self = Self {
        wind_mps: Vector3::new(0.0, 0.0, 0.0),
        gust_mps: Vector3::new(0.0, 0.0, 0.0),
        gust_rates_radps: Vector3::new(0.0, 0.0, 0.0),
    };
}

impl State {
    /// Velocity through the air, body axes, m/s.
    pub fn air_velocity_mps(&self, motion: &AirMotion) -> Vector3<f64> {
        self.attitude
            .inverse_transform_vector(&(self.velocity_mps - motion.wind_mps))
            - motion.gust_mps
    }

    /// Height above mean sea level, m.
    pub fn altitude_m(&self) -> f64 {
        -self.position_m.z
    }

    /// Roll, pitch and heading, rad: aircraft sequence yaw, pitch, roll.
    pub fn euler_rad(&self) -> (f64, f64, f64) {
        let q = self.attitude.quaternion();
        let (w, x, y, z) = (q.w, q.i, q.j, q.k);
        let roll = libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
        let pitch = libm::asin((2.0 * (w * y - z * x)).clamp(-1.0, 1.0));
        let heading = libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
        (roll, pitch, heading)
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        // A sum is finite only if each summand is, as long as none overflows.
        let sum = self.position_m.sum()
            + self.velocity_mps.sum()
            + self.rates_radps.sum()
            + self.attitude.coords.sum();
        sum.is_finite()
    }
}
