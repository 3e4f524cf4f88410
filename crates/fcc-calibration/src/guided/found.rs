//! What a guided calibration finds, and how good it is.

use super::Refusal;
use crate::{Axes, Mounting, Rotation};

/// What was found.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Found {
    /// The calibration.
    pub values: Values,
    /// How good it is.
    pub quality: Quality,
    /// The standard deviation of the worst bias, or of the angles, in the unit
    /// of the sensor or rad; of a gyroscope that was turned, of the worst of scale
    /// and misalignment.
    pub sigma: f64,
}

/// The values of a calibration, in SI units, and µT.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Values {
    /// Bias, scale and misalignment.
    Accelerometer(Axes),
    /// Bias, scale and misalignment.
    Gyroscope {
        /// The bias in rad/s.
        axes: Axes,
        /// By how much gravity's direction after a turn differs from the one before
        /// it, turned: RMS of each of two angles, rad.
        residual_rad: f64,
        /// The standard deviation of the worst bias, rad/s.
        bias_sigma_radps: f64,
    },
    /// The bias alone.
    GyroscopeBias {
        /// rad/s.
        bias_radps: [f64; 3],
    },
    /// Hard and soft iron, and how it is turned.
    Magnetometer {
        /// Bias, scale and misalignment.
        axes: Axes,
        /// The mounting, and the free rotation from there, if the accelerometer
        /// tells it.
        mounting: Option<(Mounting, Rotation)>,
        /// The strength of the field to which it was scaled, µT.
        strength_ut: f64,
        /// Whether that is the earth's; otherwise it is as measured.
        is_of_model: bool,
    },
    /// The zero.
    Airspeed {
        /// Pa.
        bias_pa: f64,
    },
    /// How the sensors are turned.
    Mounting {
        /// The closest of the right-angled ones.
        mounting: Mounting,
        /// The free rotation from there.
        rotation: Rotation,
    },
}

/// How good a calibration is: the error that is left, in the unit of the sensor
/// or rad; of a gyroscope that was turned, a share of the rate. That of an
/// accelerometer and a magnetometer is how far the strengths of the calibrated
/// samples differ from the true one, one standard deviation; that of the others is
/// how uncertain the value is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Quality {
    /// The error that is left.
    pub error: f64,
    /// The largest that is accepted.
    pub limit: f64,
}

impl Quality {
    pub(super) fn within(error: f64, limit: f64) -> Result<Self, Refusal> {
        if error <= limit {
            Ok(Self { error, limit })
        } else {
            Err(Refusal::Poor { error, limit })
        }
    }
}
