//! How navigation by raw readings is configured.

use core::time::Duration;

/// What is known of the earth's magnetic field: headings are magnetic, and
/// velocities of a satellite receiver refer to true north.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum MagneticNorth {
    /// The field here: north, east, down, µT.
    Field([f64; 3]),
    /// The World Magnetic Model of this year, at the first fix of a satellite
    /// receiver.
    ModelOf(f64),
}

/// The configuration of [`RawNavigation`](super::RawNavigation).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RawNavigationConfig {
    /// As [`KalmanConfig::delay`](crate::inertial::KalmanConfig::delay).
    pub delay: Duration,
    /// The magnetic field.
    pub north: MagneticNorth,
}
