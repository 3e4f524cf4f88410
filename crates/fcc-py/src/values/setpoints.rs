//! What the autopilot aims for.

use fcc_core::flight::Setpoints;
use pyo3::prelude::*;

/// What the autopilot aims for: indicated airspeed in m/s, heading, roll and
/// pitch in rad, altitude in m, climb rate in m/s; the mode that guidance
/// flies, which part of it, and for how long by now, s.
#[pyclass(name = "Setpoints", module = "fcc", frozen, get_all)]
#[derive(Clone, Copy)]
pub(crate) struct PySetpoints {
    airspeed_mps: f64,
    heading_rad: f64,
    altitude_m: f64,
    roll_rad: f64,
    climb_rate_mps: f64,
    pitch_rad: f64,
    guidance_mode: &'static str,
    guidance_item: u32,
    guidance_elapsed_s: f64,
}

impl From<Setpoints> for PySetpoints {
    fn from(setpoints: Setpoints) -> Self {
        Self {
            airspeed_mps: setpoints.airspeed_mps,
            heading_rad: setpoints.heading_rad,
            altitude_m: setpoints.altitude_m,
            roll_rad: setpoints.roll_rad,
            climb_rate_mps: setpoints.climb_rate_mps,
            pitch_rad: setpoints.pitch_rad,
            guidance_mode: setpoints.guidance.mode.name(),
            guidance_item: setpoints.guidance.item,
            guidance_elapsed_s: setpoints.guidance.elapsed_s,
        }
    }
}

#[pymethods]
impl PySetpoints {
    fn __repr__(&self) -> String {
        format!(
            "Setpoints(airspeed_mps={:.2}, heading_rad={:.4}, altitude_m={:.1})",
            self.airspeed_mps, self.heading_rad, self.altitude_m
        )
    }
}
