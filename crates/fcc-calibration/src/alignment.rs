//! How a sensor is turned in the aircraft, from known attitudes of the aircraft.

use libm::{acos, asin, atan2, sqrt};
use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

use super::{Mounting, Rotation};
use fcc_core::flight::orientation::EulerAngles;

/// Steps of the search for a constant dip; three are enough from 20° away.
const STEPS: usize = 10;
/// A step that changes less ends it, rad.
const SMALL_RAD: f64 = 1e-12;
/// Attitudes without which four unknowns are not determined well.
const LEAST_ATTITUDES: usize = 12;

impl Rotation {
    /// The rotation of which [`Rotation::of_angles`] is the other direction: how
    /// the axes are turned. At a pitch of ±90° roll and heading are not
    /// separate.
    pub fn angles(&self) -> EulerAngles {
        let Self([[xx, ..], [yx, ..], [zx, zy, zz]]) = *self;
        EulerAngles {
            roll_rad: atan2(zy, zz),
            pitch_rad: asin((-zx).clamp(-1.0, 1.0)),
            heading_rad: atan2(yx, xx),
        }
    }

    /// The rotation back.
    #[must_use]
    pub fn back(&self) -> Self {
        Self::of(matrix(self).transpose())
    }

    /// By how much it turns, rad, 0..=π.
    pub fn angle_rad(&self) -> f64 {
        let cosine = 0.5 * (matrix(self).trace() - 1.0);
        acos(cosine.clamp(-1.0, 1.0))
    }

    /// The closest right-angled mounting, and the free rotation from there.
    ///
    /// ```
    /// use fcc_calibration::Rotation;
    /// use fcc_core::flight::orientation::EulerAngles;
    ///
    /// // A board that is turned by 92° to the right.
    /// let heading_rad = 92.0_f64.to_radians();
    /// let turned = Rotation::of_angles(EulerAngles { heading_rad, ..EulerAngles::default() });
    /// let (mounting, free) = turned.mounting();
    /// assert_eq!(mounting.to_string(), "right-backward-down");
    /// assert!((free.angles().heading_rad - 2.0_f64.to_radians()).abs() < 1e-12);
    /// ```
    pub fn mounting(&self) -> (Mounting, Self) {
        let shared = |of: Mounting| matrix(&of.rotation()).component_mul(&matrix(self)).sum();
        let closest = Mounting::all().fold(Mounting::default(), |best, other| {
            if shared(other) > shared(best) {
                other
            } else {
                best
            }
        });
        (closest, self.after(&closest.rotation().back()))
    }

    fn of(matrix: Matrix3<f64>) -> Self {
        Self(matrix.transpose().data.0)
    }

    /// Of a rotation vector (Rodrigues).
    fn of_vector(vector: Vector3<f64>) -> Self {
        Self::of(nalgebra::Rotation3::new(vector).into_inner())
    }
}

fn matrix(of: &Rotation) -> Matrix3<f64> {
    let Rotation([x, y, z]) = *of;
    Matrix3::from_columns(&[x.into(), y.into(), z.into()]).transpose()
}

/// The smallest rotation after which the specific force of a level aircraft at
/// rest points up: a correction of roll and pitch. `None` if there is no force,
/// or it points down: then the mounting is another one.
///
/// ```
/// use fcc_calibration::levelled;
///
/// // A shelf that rises by 5° forward.
/// let (sin, cos) = 5.0_f64.to_radians().sin_cos();
/// let level = levelled([9.81 * sin, 0.0, -9.81 * cos]).unwrap();
/// assert!((level.angles().pitch_rad.to_degrees() - 5.0).abs() < 1e-9);
/// ```
pub fn levelled(force_mps2: [f64; 3]) -> Option<Rotation> {
    let force = Vector3::from(force_mps2).try_normalize(0.0)?;
    let turn = nalgebra::Rotation3::rotation_between(&force, &-Vector3::z())?;
    Some(Rotation::of(turn.into_inner()))
}

/// From sensor axes to body axes, by the specific force of the aircraft at rest:
/// level, and with its nose raised (the TRIAD algorithm, Black 1964). Raising
/// the nose turns the force in the plane of symmetry. `None` if both forces are
/// parallel.
///
/// ```
/// use fcc_calibration::level_and_nose_up;
///
/// // A phone under the aircraft, screen down, top forward; then 30° nose up.
/// let nose_up = [0.0, 9.81 * 0.5, -9.81 * 0.75_f64.sqrt()];
/// let rotation = level_and_nose_up([0.0, 0.0, -9.81], nose_up).unwrap();
/// assert_eq!(rotation.mounting().0.to_string(), "left-forward-down");
/// ```
pub fn level_and_nose_up(level_mps2: [f64; 3], nose_up_mps2: [f64; 3]) -> Option<Rotation> {
    let down = -Vector3::from(level_mps2).try_normalize(0.0)?;
    let right = down
        .cross(&Vector3::from(nose_up_mps2))
        .try_normalize(0.0)?;
    let forward = right.cross(&down);
    Some(Rotation([forward.into(), right.into(), down.into()]))
}

/// The alignment of a magnetometer with the other sensors.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct DipFit {
    /// From the magnetometer's axes to the others'.
    pub rotation: Rotation,
    /// By how much the angle between the field and the horizontal still differs
    /// between attitudes, RMS, rad.
    pub residual_rad: f64,
}

/// The rotation of a magnetometer after which the field has the same dip in all
/// attitudes: pairs of the direction down, in the axes that are aligned with, and
/// of the field in the magnetometer's own. Least squares, by Gauss and Newton,
/// from the closest of the right-angled mountings. (The principle: Kok and Schön,
/// *Magnetometer calibration using inertial sensors*, 2016, section III.)
///
/// `None` if there are fewer than 12 attitudes, or they do not determine it.
///
/// ```
/// use fcc_calibration::constant_dip;
/// use fcc_core::flight::orientation::{EulerAngles, earth_to_body, quaternion_from_euler};
///
/// // In middle latitudes, by a magnetometer whose x axis points backward and
/// // whose y axis points left.
/// let pairs: Vec<_> = (0..40)
///     .map(|n| {
///         let attitude = quaternion_from_euler(EulerAngles {
///             roll_rad: 0.4 * f64::from(n),
///             pitch_rad: 1.2 * (0.7 * f64::from(n)).sin(),
///             heading_rad: 1.1 * f64::from(n),
///         });
///         let [x, y, z] = earth_to_body(attitude, [21.0, 0.0, 45.0]);
///         (earth_to_body(attitude, [0.0, 0.0, 1.0]), [-x, -y, z])
///     })
///     .collect();
/// let fit = constant_dip(pairs.iter().copied()).unwrap();
/// assert_eq!(fit.rotation.mounting().0.to_string(), "backward-left-down");
/// assert!(fit.residual_rad < 1e-6);
/// ```
pub fn constant_dip(
    pairs: impl ExactSizeIterator<Item = ([f64; 3], [f64; 3])> + Clone,
) -> Option<DipFit> {
    if pairs.len() < LEAST_ATTITUDES {
        return None;
    }
    let units = pairs.map(|(down, field)| (unit(down), unit(field)));
    let varies = |by: &Matrix3<f64>| variation(units.clone(), by);
    let start = Mounting::all().map(|of| matrix(&of.rotation()));
    let mut rotation = start.min_by(|one, other| varies(one).total_cmp(&varies(other)))?;
    for _ in 0..STEPS {
        let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for (down, field) in units.clone() {
            let turned = rotation * field;
            // down · (field + turn x field) is the same for all.
            let by_turn = turned.cross(&down);
            let row = Vector4::new(by_turn.x, by_turn.y, by_turn.z, -1.0);
            normal += row * row.transpose();
            right -= row * down.dot(&turned);
        }
        let found = normal.try_inverse()? * right;
        let turn = Vector3::new(found.x, found.y, found.z);
        rotation = matrix(&Rotation::of_vector(turn)) * rotation;
        if turn.norm() < SMALL_RAD {
            break;
        }
    }
    let residual_rad = sqrt(varies(&rotation));
    let is_found = residual_rad.is_finite() && rotation.iter().all(|part| part.is_finite());
    is_found.then(|| DipFit {
        rotation: Rotation::of(rotation),
        residual_rad,
    })
}

fn unit(vector: [f64; 3]) -> Vector3<f64> {
    Vector3::from(vector).try_normalize(0.0).unwrap_or_default()
}

/// The variance of the dip, by its sine, over its cosine at the mean: of small
/// differences that of the angle in rad².
fn variation(units: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>, by: &Matrix3<f64>) -> f64 {
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for (down, field) in units {
        let sine = down.dot(&(by * field));
        count += 1.0;
        sum += sine;
        squares += sine * sine;
    }
    let mean = sum / count;
    // At a magnetic pole the sine says nothing of small angles.
    (squares / count - mean * mean).max(0.0) / (1.0 - mean * mean).max(0.01)
}
