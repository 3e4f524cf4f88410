//! What navigation makes of the measurements.

use fcc_core::flight::navigation::Estimate;
use pyo3::prelude::*;

/// What navigation makes of the measurements: angles in rad (the heading
/// counts on through full turns), rates in rad/s, airspeeds in m/s, altitude
/// in m, climb rate in m/s, side force in m/s².
#[pyclass(name = "Estimate", module = "fcc", frozen, get_all)]
#[derive(Clone, Copy)]
pub(crate) struct PyEstimate {
    roll_rad: f64,
    pitch_rad: f64,
    heading_rad: f64,
    roll_rate_radps: f64,
    pitch_rate_radps: f64,
    yaw_rate_radps: f64,
    airspeed_mps: f64,
    true_airspeed_mps: f64,
    altitude_m: f64,
    climb_rate_mps: f64,
    side_force_mps2: f64,
}

impl From<Estimate> for PyEstimate {
    fn from(estimate: Estimate) -> Self {
        Self {
            roll_rad: estimate.roll_rad,
            pitch_rad: estimate.pitch_rad,
            heading_rad: estimate.heading_rad,
            roll_rate_radps: estimate.body_rates.roll_radps,
            pitch_rate_radps: estimate.body_rates.pitch_radps,
            yaw_rate_radps: estimate.body_rates.yaw_radps,
            airspeed_mps: estimate.airspeed_mps,
            true_airspeed_mps: estimate.true_airspeed_mps,
            altitude_m: estimate.altitude_m,
            climb_rate_mps: estimate.climb_rate_mps,
            side_force_mps2: estimate.side_force_mps2,
        }
    }
}

#[pymethods]
impl PyEstimate {
    fn __repr__(&self) -> String {
        format!(
            "Estimate(roll_rad={:.4}, pitch_rad={:.4}, heading_rad={:.4}, airspeed_mps={:.2}, \
             altitude_m={:.1}, climb_rate_mps={:.2})",
            self.roll_rad,
            self.pitch_rad,
            self.heading_rad,
            self.airspeed_mps,
            self.altitude_m,
            self.climb_rate_mps
        )
    }
}
