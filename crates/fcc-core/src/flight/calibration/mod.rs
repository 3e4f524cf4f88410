//! From what a sensor with three axes gives to body axes: mounting, bias, scale and
//! misalignment.

mod mounting;

pub use mounting::{Direction, Mounting, MountingError, Rotation};

/// The calibration of a sensor with three axes.
///
/// The vector is C · R · T · K · (measured - bias): R is the mounting, C a free
/// rotation, K the scales, and T the misalignment of the sensor's axes
/// (Tedaldi, Pretto and Menegatti 2014, equations 2 to 6). For a magnetometer
/// the bias is the hard iron, and T · K the soft iron.
///
/// ```
/// use fcc_core::flight::calibration::{AxesCalibration, Axes};
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
/// # Ok::<(), fcc_core::flight::calibration::MountingError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AxesCalibration {
    matrix: Rotation,
    bias: [f64; 3],
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
}

impl Default for Axes {
    fn default() -> Self {
        Self {
            mounting: Mounting::default(),
            rotation: Rotation::NONE,
            bias: [0.0; 3],
            scale: [1.0; 3],
            misalignment: [0.0; 6],
        }
    }
}

impl AxesCalibration {
    /// Works out the calibration.
    pub fn new(of: &Axes) -> Self {
        let [kx, ky, kz] = of.scale;
        let [xy, xz, yx, yz, zx, zy] = of.misalignment;
        let shape = Rotation([
            [kx, xy * ky, xz * kz],
            [yx * kx, ky, yz * kz],
            [zx * kx, zy * ky, kz],
        ]);
        Self {
            matrix: of.rotation.after(&of.mounting.rotation()).after(&shape),
            bias: of.bias,
        }
    }

    /// The vector in body axes of one in the sensor's axes.
    pub fn applied(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [bx, by, bz] = self.bias;
        self.matrix.turned([x - bx, y - by, z - bz])
    }
}

impl Default for AxesCalibration {
    fn default() -> Self {
        Self::new(&Axes::default())
    }
}

#[cfg(test)]
mod tests;
