//! Guided calibration of a configuration's raw sensors, and the file of what was
//! found.
//!
//! A [`CalibrationSession`] opens the sensors as a flight does, but none of their
//! calibrations and no actuator, and passes what they give to
//! [`GuidedCalibration`](fcc_core::flight::calibration::GuidedCalibration). What
//! it finds is an [`Entry`] of the [`CalibrationFile`], in the configuration's own
//! keys; [`apply`] puts the entries over the configuration of a flight.

mod apply;
mod entry;
mod file;
mod session;

use fcc_core::flight::Measurements;
pub use fcc_sim::HandlingFault;
use serde::{Deserialize, Serialize};

pub use apply::{Applied, apply};
pub use entry::Entry;
#[cfg(fuzzing)]
pub use file::read_calibration;
pub use file::{CalibrationFile, CalibrationFileError, LockedCalibrationFile};
pub use session::{CalibrationSession, SessionError};

/// What can be calibrated.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CalibrationKind {
    /// Bias, scale and misalignment, held still in twelve positions.
    Accelerometer,
    /// The bias, left alone.
    Gyroscope,
    /// Hard and soft iron, and how it is turned, turned through all directions.
    Magnetometer,
    /// The zero of the differential pressure, without wind.
    Airspeed,
    /// How accelerometer and gyroscope are turned in the aircraft.
    Mounting,
}

impl CalibrationKind {
    /// All of them, in the order in which they are best done.
    pub const ALL: [Self; 5] = [
        Self::Gyroscope,
        Self::Accelerometer,
        Self::Mounting,
        Self::Magnetometer,
        Self::Airspeed,
    ];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accelerometer => "accelerometer",
            Self::Gyroscope => "gyroscope",
            Self::Magnetometer => "magnetometer",
            Self::Airspeed => "airspeed",
            Self::Mounting => "mounting",
        }
    }

    /// What the error of such a calibration is in: of the mounting, which the
    /// core has in rad, in degrees.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Accelerometer => "m/s²",
            Self::Gyroscope => "°/s",
            Self::Magnetometer => "µT",
            Self::Airspeed => "Pa",
            Self::Mounting => "°",
        }
    }

    /// A value in this unit, of one in the core's.
    pub const fn in_unit(self, value: f64) -> f64 {
        match self {
            Self::Gyroscope | Self::Mounting => value.to_degrees(),
            Self::Accelerometer | Self::Magnetometer | Self::Airspeed => value,
        }
    }

    /// Whether the measurements contain what it needs.
    fn is_in(self, measured: &Measurements) -> bool {
        let never = match self {
            Self::Accelerometer | Self::Mounting => measured.raw_specific_force.is_never(),
            Self::Gyroscope => measured.raw_body_rates.is_never(),
            Self::Magnetometer => measured.magnetic_field.is_never(),
            Self::Airspeed => measured.differential_pressure_pa.is_never(),
        };
        !never
    }
}
