//! Guided calibration of a configuration's raw sensors, and the file of what was
//! found.
//!
//! A [`CalibrationSession`] opens the sensors as a flight does, but none of their
//! calibrations and no actuator, and passes what they give to
//! [`GuidedCalibration`](fcc_calibration::GuidedCalibration). What
//! it finds is an [`Entry`] of the [`CalibrationFile`], in the configuration's own
//! keys; [`apply`] puts the entries over the configuration of a flight.

mod apply;
mod entry;
mod file;
mod hands;
mod order;
mod session;
mod words;

use fcc_core::flight::Measurements;
pub use fcc_sim::HandlingFault;
use serde::{Deserialize, Serialize};

pub use apply::{Applied, apply, not_calibrated};
pub use entry::Entry;
#[cfg(fuzzing)]
pub use file::read_calibration;
pub use file::{CalibrationFile, CalibrationFileError, LockedCalibrationFile};
pub use session::{CalibrationSession, SessionError};
pub use words::{beforehand, words};

/// How much of a calibration is done.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Extent {
    /// All of it.
    #[default]
    Whole,
    /// Of a gyroscope the bias, of the mounting roll and pitch: what an aircraft
    /// that cannot be turned allows.
    Part,
}

/// What can be calibrated.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CalibrationKind {
    /// Bias, scale and misalignment, held still in twelve positions.
    Accelerometer,
    /// Bias, scale and misalignment, left alone and then turned between positions
    /// at rest; in [part](Extent::Part) the bias.
    Gyroscope,
    /// Hard and soft iron, and how it is turned, turned through all directions.
    Magnetometer,
    /// The zero of the differential pressure, without wind.
    Airspeed,
    /// How accelerometer and gyroscope are turned in the aircraft; in
    /// [part](Extent::Part) roll and pitch.
    Mounting,
}

impl CalibrationKind {
    /// All of them, in the order in which they are best done.
    pub const ALL: [Self; 5] = [
        Self::Accelerometer,
        Self::Gyroscope,
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
