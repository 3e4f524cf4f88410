//! The values that travel, as Python sees them: SI and radians.

use fcc_core::flight::{
    Attitude, BodyRates, Measurements, Plant, PlantState, Setpoints, SpecificForce, Surfaces,
};
use fcc_core::framework::{Reading, Time};
use pyo3::prelude::*;

/// What the sensors measure at one instant.
///
/// Pitch, roll and magnetic heading in rad; body rates in rad/s; specific
/// force along the body axes in m/s² (z is -9.81 in level flight); indicated
/// airspeed in m/s; barometric altitude in m.
#[pyclass(name = "Measurements", get_all, set_all)]
#[derive(Clone, Copy, Default)]
pub(crate) struct PyMeasurements {
    pub(crate) pitch_rad: f64,
    pub(crate) roll_rad: f64,
    pub(crate) heading_rad: f64,
    pub(crate) roll_rate_radps: f64,
    pub(crate) pitch_rate_radps: f64,
    pub(crate) yaw_rate_radps: f64,
    pub(crate) specific_force_x_mps2: f64,
    pub(crate) specific_force_y_mps2: f64,
    pub(crate) specific_force_z_mps2: f64,
    pub(crate) airspeed_mps: f64,
    pub(crate) altitude_m: f64,
}

#[pymethods]
impl PyMeasurements {
    #[new]
    #[pyo3(signature = (*, pitch_rad, roll_rad, heading_rad,
        roll_rate_radps, pitch_rate_radps, yaw_rate_radps,
        specific_force_x_mps2, specific_force_y_mps2, specific_force_z_mps2,
        airspeed_mps, altitude_m))]
    #[expect(
        clippy::too_many_arguments,
        reason = "by keyword only, as in a data class"
    )]
    const fn new(
        pitch_rad: f64,
        roll_rad: f64,
        heading_rad: f64,
        roll_rate_radps: f64,
        pitch_rate_radps: f64,
        yaw_rate_radps: f64,
        specific_force_x_mps2: f64,
        specific_force_y_mps2: f64,
        specific_force_z_mps2: f64,
        airspeed_mps: f64,
        altitude_m: f64,
    ) -> Self {
        Self {
            pitch_rad,
            roll_rad,
            heading_rad,
            roll_rate_radps,
            pitch_rate_radps,
            yaw_rate_radps,
            specific_force_x_mps2,
            specific_force_y_mps2,
            specific_force_z_mps2,
            airspeed_mps,
            altitude_m,
        }
    }
}

impl PyMeasurements {
    /// The core's measurements, all taken now, on a plant whose clock reads
    /// `time_s`.
    pub(crate) fn to_core(self, now: Time, time_s: f64, standing: Surfaces) -> Measurements {
        Measurements {
            attitude: Reading::new(
                Attitude {
                    pitch_rad: self.pitch_rad,
                    roll_rad: self.roll_rad,
                },
                now,
            ),
            heading_rad: Reading::new(self.heading_rad, now),
            body_rates: Reading::new(
                BodyRates {
                    roll_radps: self.roll_rate_radps,
                    pitch_radps: self.pitch_rate_radps,
                    yaw_radps: self.yaw_rate_radps,
                },
                now,
            ),
            specific_force: Reading::new(
                SpecificForce {
                    x_mps2: self.specific_force_x_mps2,
                    y_mps2: self.specific_force_y_mps2,
                    z_mps2: self.specific_force_z_mps2,
                },
                now,
            ),
            airspeed_mps: Reading::new(self.airspeed_mps, now),
            altitude_m: Reading::new(self.altitude_m, now),
            surfaces: Reading::new(standing, now),
            plant: Reading::new(
                Plant {
                    time_s,
                    state: PlantState::Running,
                },
                now,
            ),
            ..Measurements::default()
        }
    }
}

/// Throttle 0..1 and surfaces -1..1: +elevator raises the nose, +aileron rolls
/// right, +rudder yaws right.
#[pyclass(name = "Surfaces", frozen, get_all)]
#[derive(Clone, Copy)]
pub(crate) struct PySurfaces {
    throttle: f64,
    elevator: f64,
    aileron: f64,
    rudder: f64,
}

impl From<Surfaces> for PySurfaces {
    fn from(surfaces: Surfaces) -> Self {
        Self {
            throttle: surfaces.throttle,
            elevator: surfaces.elevator,
            aileron: surfaces.aileron,
            rudder: surfaces.rudder,
        }
    }
}

#[pymethods]
impl PySurfaces {
    fn __repr__(&self) -> String {
        format!(
            "Surfaces(throttle={:.3}, elevator={:+.3}, aileron={:+.3}, rudder={:+.3})",
            self.throttle, self.elevator, self.aileron, self.rudder
        )
    }
}

/// What the autopilot aims for: indicated airspeed in m/s, heading, roll and
/// pitch in rad, altitude in m, climb rate in m/s.
#[pyclass(name = "Setpoints", frozen, get_all)]
#[derive(Clone, Copy)]
pub(crate) struct PySetpoints {
    airspeed_mps: f64,
    heading_rad: f64,
    altitude_m: f64,
    roll_rad: f64,
    climb_rate_mps: f64,
    pitch_rad: f64,
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
        }
    }
}
