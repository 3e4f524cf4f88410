//! From what a sensor gives to what is measured: mounting, bias, scale,
//! misalignment and delay.
//!
//! [`Calibration::applied`] is the only place in which they are applied: to the
//! raw readings of one source, before anything else sees them. So every record
//! has body axes, calibrated, at the time at which they were taken.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod alignment;
mod fit;
mod guided;
mod mounting;
mod turning;

use core::ops::RangeInclusive;
use core::time::Duration;

pub use alignment::{DipFit, constant_dip, level_and_nose_up, levelled};
pub use fit::{FitError, StrengthFit, fit_strength};
pub use guided::{
    CELLS, CELLS_OF_BANDS, Coverage, EarthField, Found, GuidedCalibration, GuidedKind, MountingWay,
    Next, Place, Quality, Refusal, Values,
};
pub use mounting::{Direction, Mounting, MountingError, Rotation};
use nalgebra::{Matrix3, SymmetricEigen};

use fcc_core::flight::{BodyRates, MagneticField, Measurements, SpecificForce};
use fcc_core::framework::Reading;

/// The calibration of a sensor with three axes.
///
/// The vector is C · R · T · K · (measured - bias): R is the mounting, C a free
/// rotation, K the scales, and T the misalignment of the sensor's axes
/// (Tedaldi, Pretto and Menegatti 2014, equations 2 to 6). For a magnetometer
/// the bias is the hard iron, and T · K the soft iron.
///
/// ```
/// use fcc_calibration::{AxesCalibration, Axes};
///
/// // A gyroscope that is turned by 90° to the right, and shows 2 % too much.
/// let calibration = AxesCalibration::new(&Axes {
///     mounting: "right-backward-down".parse()?,
///     bias: [0.01, 0.0, 0.0],
///     scale: [1.0 / 1.02; 3],
///     ..Axes::default()
/// });
/// let [roll_radps, pitch_radps, _] = calibration.applied([0.01 + 0.102, 0.0, 0.0]);
/// assert!(roll_radps.abs() < 1e-12 && (pitch_radps - 0.1).abs() < 1e-12);
/// # Ok::<(), fcc_calibration::MountingError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AxesCalibration {
    matrix: Rotation,
    bias: [f64; 3],
    delay: Duration,
}

/// What a calibration of three axes consists of; the default changes nothing.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Axes {
    /// Where the axes point.
    pub mounting: Mounting,
    /// How the sensor is turned from there.
    pub rotation: Rotation,
    /// What it gives where there is nothing, in its unit and its axes.
    pub bias: [f64; 3],
    /// The true value of each axis over what it gives.
    pub scale: [f64; 3],
    /// How much of an axis belongs to another one: of x that of y and z, of y
    /// that of x and z, of z that of x and y; angles in rad, of soft iron
    /// ratios.
    pub misalignment: [f64; 6],
    /// From the measured event to its arrival.
    pub delay: Duration,
}

impl Default for Axes {
    fn default() -> Self {
        Self {
            mounting: Mounting::default(),
            rotation: Rotation::NONE,
            bias: [0.0; 3],
            scale: [1.0; 3],
            misalignment: [0.0; 6],
            delay: Duration::ZERO,
        }
    }
}

impl Axes {
    /// From sensor axes to body axes: the mounting, then the free rotation.
    pub fn turn(&self) -> Rotation {
        self.rotation.after(&self.mounting.rotation())
    }

    /// By how much scale and misalignment together may multiply what is measured
    /// along any direction: twice what a scale may do. Below it a direction is
    /// lost, as if two of the sensor's axes were one.
    pub const MULTIPLIES: RangeInclusive<f64> = 0.25..=4.0;

    /// Scale and misalignment, T · K.
    fn shape(&self) -> [[f64; 3]; 3] {
        let [kx, ky, kz] = self.scale;
        let [xy, xz, yx, yz, zx, zy] = self.misalignment;
        [
            [kx, xy * ky, xz * kz],
            [yx * kx, ky, yz * kz],
            [zx * kx, zy * ky, kz],
        ]
    }

    /// By how much scale and misalignment multiply what is measured, along the
    /// direction in which that is least and the one in which it is most: the
    /// extreme singular values of T · K.
    ///
    /// ```
    /// use fcc_calibration::Axes;
    ///
    /// // Three axes that show almost the same direction.
    /// let singular = Axes { misalignment: [-0.49; 6], ..Axes::default() };
    /// let (least, most) = singular.multiplies();
    /// assert!((least - 0.02).abs() < 1e-9 && (most - 1.49).abs() < 1e-9);
    /// ```
    pub fn multiplies(&self) -> (f64, f64) {
        let shape = Matrix3::from(self.shape());
        let squares = SymmetricEigen::new(shape * shape.transpose()).eigenvalues;
        let root = |square: f64| libm::sqrt(square.max(0.0));
        (root(squares.min()), root(squares.max()))
    }
}

impl AxesCalibration {
    /// Works out the calibration.
    pub fn new(of: &Axes) -> Self {
        Self::turned(of, &of.turn())
    }

    /// The calibration of a sensor, into axes to which `turn` takes its own.
    pub(crate) fn turned(of: &Axes, turn: &Rotation) -> Self {
        Self {
            matrix: turn.after(&Rotation(of.shape())),
            bias: of.bias,
            delay: of.delay,
        }
    }

    /// C · R · T · K, by rows.
    pub const fn matrix(&self) -> [[f64; 3]; 3] {
        self.matrix.0
    }

    /// The vector in body axes of one in the sensor's axes.
    pub fn applied(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [bx, by, bz] = self.bias;
        self.matrix.turned([x - bx, y - by, z - bz])
    }

    fn reading<T: Copy + Default>(
        &self,
        measured: Reading<T>,
        split: impl Fn(T) -> [f64; 3],
        join: impl Fn([f64; 3]) -> T,
    ) -> Reading<T> {
        taken_or_never(Reading {
            value: join(self.applied(split(measured.value))),
            taken: measured.taken - self.delay,
            ..measured
        })
    }
}

impl Default for AxesCalibration {
    fn default() -> Self {
        Self::new(&Axes::default())
    }
}

/// The calibration of a sensor of one number: (measured - bias) · scale.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ScalarCalibration {
    /// What it gives where there is nothing, in its unit.
    pub bias: f64,
    /// The true value over what it gives.
    pub scale: f64,
    /// From the measured event to its arrival.
    pub delay: Duration,
}

impl Default for ScalarCalibration {
    fn default() -> Self {
        Self {
            bias: 0.0,
            scale: 1.0,
            delay: Duration::ZERO,
        }
    }
}

impl ScalarCalibration {
    fn reading(&self, measured: Reading<f64>) -> Reading<f64> {
        taken_or_never(Reading {
            value: (measured.value - self.bias) * self.scale,
            taken: measured.taken - self.delay,
            ..measured
        })
    }
}

/// The calibration of the raw readings of one source; the default changes
/// nothing.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::flight::Measurements;
/// use fcc_calibration::{Calibration, ScalarCalibration};
/// use fcc_core::framework::{Reading, Time};
///
/// let barometer = ScalarCalibration {
///     bias: 30.0,
///     delay: Duration::from_millis(20),
///     ..ScalarCalibration::default()
/// };
/// let calibration = Calibration { static_pressure: barometer, ..Calibration::default() };
/// let arrived = Time::from_nanos(500_000_000);
/// let given = Measurements {
///     static_pressure_pa: Reading::new(90_842.0, arrived),
///     ..Measurements::default()
/// };
/// let taken = Time::from_nanos(480_000_000);
/// let measured = calibration.applied(&given);
/// assert_eq!(measured.static_pressure_pa, Reading::new(90_812.0, taken));
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Calibration {
    /// Of the raw specific force, m/s².
    pub accelerometer: AxesCalibration,
    /// Of the raw body rates, rad/s.
    pub gyroscope: AxesCalibration,
    /// Of the magnetic field, µT.
    pub magnetometer: AxesCalibration,
    /// Of the static pressure, Pa.
    pub static_pressure: ScalarCalibration,
    /// Of the differential pressure, Pa.
    pub differential_pressure: ScalarCalibration,
    /// Of the air's temperature, K.
    pub air_temperature: ScalarCalibration,
    /// Of the range, m.
    pub range: ScalarCalibration,
    /// How late a fix of satellite navigation arrives.
    pub gnss_delay: Duration,
}

impl Calibration {
    /// The measurements of a source as it gives them, with its raw readings
    /// calibrated. What is not raw is unchanged, and what was never taken stays
    /// so.
    pub fn applied(&self, given: &Measurements) -> Measurements {
        let raw_specific_force = self.accelerometer.reading(
            given.raw_specific_force,
            |f| [f.x_mps2, f.y_mps2, f.z_mps2],
            |[x_mps2, y_mps2, z_mps2]| SpecificForce {
                x_mps2,
                y_mps2,
                z_mps2,
            },
        );
        let raw_body_rates = self.gyroscope.reading(
            given.raw_body_rates,
            |r| [r.roll_radps, r.pitch_radps, r.yaw_radps],
            |[roll_radps, pitch_radps, yaw_radps]| BodyRates {
                roll_radps,
                pitch_radps,
                yaw_radps,
            },
        );
        let magnetic_field = self.magnetometer.reading(
            given.magnetic_field,
            |m| [m.x_ut, m.y_ut, m.z_ut],
            |[x_ut, y_ut, z_ut]| MagneticField { x_ut, y_ut, z_ut },
        );
        Measurements {
            raw_specific_force,
            raw_body_rates,
            magnetic_field,
            static_pressure_pa: self.static_pressure.reading(given.static_pressure_pa),
            differential_pressure_pa: self
                .differential_pressure
                .reading(given.differential_pressure_pa),
            air_temperature_k: self.air_temperature.reading(given.air_temperature_k),
            range_m: self.range.reading(given.range_m),
            gnss: Reading {
                taken: given.gnss.taken - self.gnss_delay,
                ..given.gnss
            },
            ..*given
        }
    }
}

/// A reading that was never taken has no value.
fn taken_or_never<T: Default>(reading: Reading<T>) -> Reading<T> {
    if reading.is_never() {
        Reading::default()
    } else {
        reading
    }
}

#[cfg(test)]
mod tests;
