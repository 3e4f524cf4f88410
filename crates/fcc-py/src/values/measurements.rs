//! What the sensors measure at one instant.

use fcc_core::flight::{
    Attitude, BodyRates, Measurements, Plant, PlantState, SpecificForce, Surfaces,
};
use fcc_core::framework::{Reading, Switch, Time};
use numpy::{PyArray1, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arguments::{numbers, shape_words};

/// Numbers in a row of measurements.
pub(crate) const N: usize = 11;

/// What the columns of a series of measurements are.
pub(crate) const COLUMNS: [&str; N] = [
    "pitch_rad",
    "roll_rad",
    "heading_rad",
    "roll_rate_radps",
    "pitch_rate_radps",
    "yaw_rate_radps",
    "specific_force_x_mps2",
    "specific_force_y_mps2",
    "specific_force_z_mps2",
    "airspeed_mps",
    "altitude_m",
];

/// What the sensors measure at one instant.
///
/// Pitch, roll and magnetic heading in rad; body rates in rad/s; specific
/// force along the body axes in m/s² (z is -9.81 in level flight); indicated
/// airspeed in m/s; barometric altitude in m.
///
/// A value that is not a number, or that no aircraft of this kind can reach,
/// is taken as in flight: as one that did not arrive. The last good one stays
/// and grows old.
#[pyclass(name = "Measurements", module = "fcc", get_all, set_all)]
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

    /// From a row of 11 numbers, in the order of `fcc.MEASUREMENTS`.
    #[staticmethod]
    fn from_array(row: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (shape, values) = numbers("row", row)?;
        <[f64; N]>::try_from(values)
            .ok()
            .filter(|_| shape.len() == 1)
            .map(|row| Self::from_row(&row))
            .ok_or_else(|| {
                PyValueError::new_err(format!(
                    "row is of shape {}: give ({N},)",
                    shape_words(&shape)
                ))
            })
    }

    /// As a row of 11 numbers, in the order of `fcc.MEASUREMENTS`.
    #[pyo3(name = "to_array")]
    fn array<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.to_row().to_pyarray(py)
    }

    fn __repr__(&self) -> String {
        let fields: Vec<_> = COLUMNS
            .iter()
            .zip(self.to_row())
            .map(|(name, value)| format!("{name}={value}"))
            .collect();
        format!("Measurements({})", fields.join(", "))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.to_row() == other.to_row()
    }
}

/// When measurements were taken, and what else a plant tells.
#[derive(Clone, Copy)]
pub(crate) struct Measured {
    /// The tick's time.
    pub(crate) now: Time,
    /// The plant's own clock.
    pub(crate) plant_s: f64,
    /// Where the controls stand, if that is known.
    pub(crate) standing: Option<Surfaces>,
    /// The engage switch, if there is one.
    pub(crate) switch: Option<Switch>,
}

impl PyMeasurements {
    pub(crate) fn from_row(row: &[f64; N]) -> Self {
        let &[
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
        ] = row;
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

    pub(crate) const fn to_row(self) -> [f64; N] {
        [
            self.pitch_rad,
            self.roll_rad,
            self.heading_rad,
            self.roll_rate_radps,
            self.pitch_rate_radps,
            self.yaw_rate_radps,
            self.specific_force_x_mps2,
            self.specific_force_y_mps2,
            self.specific_force_z_mps2,
            self.airspeed_mps,
            self.altitude_m,
        ]
    }

    /// The core's measurements, all taken now.
    pub(crate) fn to_core(self, told: &Measured) -> Measurements {
        let now = told.now;
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
            surfaces: told
                .standing
                .map(|standing| Reading::new(standing, now))
                .unwrap_or_default(),
            engage_switch: told
                .switch
                .map(|switch| Reading::new(switch, now))
                .unwrap_or_default(),
            plant: Reading::new(
                Plant {
                    time_s: told.plant_s,
                    state: PlantState::Running,
                },
                now,
            ),
            ..Measurements::default()
        }
    }

    /// What the core's measurements say, NaN for what never came.
    pub(crate) fn from_core(core: &Measurements) -> Self {
        fn value<T: Copy>(reading: &Reading<T>, of: impl Fn(T) -> f64) -> f64 {
            if reading.is_never() {
                f64::NAN
            } else {
                of(reading.value)
            }
        }
        Self {
            pitch_rad: value(&core.attitude, |v| v.pitch_rad),
            roll_rad: value(&core.attitude, |v| v.roll_rad),
            heading_rad: value(&core.heading_rad, |v| v),
            roll_rate_radps: value(&core.body_rates, |v| v.roll_radps),
            pitch_rate_radps: value(&core.body_rates, |v| v.pitch_radps),
            yaw_rate_radps: value(&core.body_rates, |v| v.yaw_radps),
            specific_force_x_mps2: value(&core.specific_force, |v| v.x_mps2),
            specific_force_y_mps2: value(&core.specific_force, |v| v.y_mps2),
            specific_force_z_mps2: value(&core.specific_force, |v| v.z_mps2),
            airspeed_mps: value(&core.airspeed_mps, |v| v),
            altitude_m: value(&core.altitude_m, |v| v),
        }
    }

    /// Writes these values over those of the core, each taken as it was.
    pub(crate) fn write_over(self, core: &mut Measurements) {
        core.attitude.value = Attitude {
            pitch_rad: self.pitch_rad,
            roll_rad: self.roll_rad,
        };
        core.heading_rad.value = self.heading_rad;
        core.body_rates.value = BodyRates {
            roll_radps: self.roll_rate_radps,
            pitch_radps: self.pitch_rate_radps,
            yaw_radps: self.yaw_rate_radps,
        };
        core.specific_force.value = SpecificForce {
            x_mps2: self.specific_force_x_mps2,
            y_mps2: self.specific_force_y_mps2,
            z_mps2: self.specific_force_z_mps2,
        };
        core.airspeed_mps.value = self.airspeed_mps;
        core.altitude_m.value = self.altitude_m;
    }
}
