//! Flow past the aircraft.

use libm::{asin, atan2, sqrt};
use nalgebra::Vector3;

/// The lowest airspeed, m/s, used to make rates dimensionless: below it dynamic
/// pressure is negligible, and 1/V must stay finite.
pub(crate) const SLOWEST_MPS: f64 = 1.0;

/// Flow past the aircraft.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Flow {
    /// True airspeed, m/s.
    pub airspeed_mps: f64,
    /// Airspeed within the plane of symmetry, m/s.
    pub symmetric_mps: f64,
    /// Angle of attack, rad.
    pub alpha_rad: f64,
    /// Sine and cosine of the angle of attack, obtained by a division.
    pub sin_cos_alpha: (f64, f64),
    /// Sideslip, rad, positive when the air comes from the right.
    pub beta_rad: f64,
}

impl Flow {
    /// From the velocity through the air, body axes, m/s.
    pub fn of(velocity: &Vector3<f64>) -> Self {
        let symmetric_mps = sqrt(velocity.x * velocity.x + velocity.z * velocity.z);
        let airspeed_mps = sqrt(symmetric_mps * symmetric_mps + velocity.y * velocity.y);
        let side = velocity.y / airspeed_mps.max(SLOWEST_MPS);
        let sin_cos_alpha = if symmetric_mps > 0.0 {
            (velocity.z / symmetric_mps, velocity.x / symmetric_mps)
        } else {
            (0.0, 1.0)
        };
        Self {
            airspeed_mps,
            symmetric_mps,
            alpha_rad: atan2(velocity.z, velocity.x),
            sin_cos_alpha,
            beta_rad: asin(side.clamp(-1.0, 1.0)),
        }
    }
}
