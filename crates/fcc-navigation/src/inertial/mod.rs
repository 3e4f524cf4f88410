//! Navigation from raw sensors: attitude, velocity, position, wind and the
//! sensors' biases from gyroscopes, accelerometers, magnetometers, pressures
//! and a satellite receiver.
//!
//! [`KalmanNavigation`] is an error-state Kalman filter, which uses what arrives and
//! says how sure it is. It computes from samples alone: no clock, no heap, the same
//! bits on every machine.

mod field_rates;
mod field_turning;
mod gyroscope_monitor;
mod kalman;
mod magnetism;
mod observation;
mod raw_navigation;
mod receiver_witness;
mod stuck;
mod units;

pub use kalman::{Innovation, KalmanConfig, KalmanNavigation};
pub use magnetism::{MAGNETIC_MODEL_YEARS, earth_field_ut};
pub use observation::{GeodeticPosition, Observation, ObservationKind, Sigma, Solution};
pub use raw_navigation::{
    FoundBy, MagneticNorth, RawNavigation, RawNavigationConfig, SensorKind, WrongSensor,
};

use fcc_core::framework::Time;

/// A method that computes where an aircraft is and how it moves from samples of
/// its sensors.
pub trait InertialNavigation {
    /// Takes a sample, and the time at which it was taken: that of its arrival
    /// minus its known delay. Samples of one sensor come in the order in which
    /// they were taken; those of different sensors in any. What is not finite
    /// is ignored.
    fn observe(&mut self, taken: Time, observation: Observation);

    /// The estimate at `now`, which never goes back, from the samples so far.
    fn step(&mut self, now: Time) -> Solution;
}
