//! The orientation of body axes relative to the earth: Euler angles,
//! quaternions, and the transformation of vectors.
//!
//! Body axes are x forward, y right, z down; earth axes are north, east, down.
//! Euler angles are the aircraft's: first the heading about down, then the
//! pitch about right, then the roll about forward. A quaternion `[w, x, y, z]`
//! is of unit length and transforms body axes to earth axes (Stevens, Lewis and
//! Johnson, *Aircraft Control and Simulation*, 2016, section 1.3; Diebel 2006,
//! section 5).

use libm::{asin, atan2, cos, sin, sqrt};

use crate::blocks::{limit_abs, wrap_two_pi};

/// Roll, pitch and heading, rad.
///
/// ```
/// use fcc_core::flight::orientation::EulerAngles;
///
/// let climbing_east = EulerAngles {
///     pitch_rad: 10.0_f64.to_radians(),
///     heading_rad: 90.0_f64.to_radians(),
///     ..EulerAngles::default()
/// };
/// assert_eq!(climbing_east.roll_rad, 0.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct EulerAngles {
    /// Right wing down, -π..π.
    pub roll_rad: f64,
    /// Nose up, -π/2..π/2.
    pub pitch_rad: f64,
    /// Clockwise from north, 0..2π.
    pub heading_rad: f64,
}

/// The quaternion `[w, x, y, z]` of Euler angles.
///
/// ```
/// use fcc_core::flight::orientation::{EulerAngles, quaternion_from_euler, body_to_earth};
///
/// let east = EulerAngles { heading_rad: core::f64::consts::FRAC_PI_2, ..Default::default() };
/// let forward = body_to_earth(quaternion_from_euler(east), [1.0, 0.0, 0.0]);
/// assert!((forward[1] - 1.0).abs() < 1e-12);
/// ```
pub fn quaternion_from_euler(angles: EulerAngles) -> [f64; 4] {
    let half = |angle: f64| (sin(0.5 * angle), cos(0.5 * angle));
    let (sin_roll, cos_roll) = half(angles.roll_rad);
    let (sin_pitch, cos_pitch) = half(angles.pitch_rad);
    let (sin_yaw, cos_yaw) = half(angles.heading_rad);
    [
        cos_roll * cos_pitch * cos_yaw + sin_roll * sin_pitch * sin_yaw,
        sin_roll * cos_pitch * cos_yaw - cos_roll * sin_pitch * sin_yaw,
        cos_roll * sin_pitch * cos_yaw + sin_roll * cos_pitch * sin_yaw,
        cos_roll * cos_pitch * sin_yaw - sin_roll * sin_pitch * cos_yaw,
    ]
}

/// The Euler angles of a quaternion, which need not be of unit length. With the
/// nose straight up or down, roll and heading are the same rotation, and its
/// division between the two is arbitrary. NaN for a quaternion of length zero.
///
/// ```
/// use core::f64::consts::FRAC_1_SQRT_2;
/// use fcc_core::flight::orientation::euler_from_quaternion;
///
/// // A quarter of a turn about the forward axis: right wing straight down.
/// let angles = euler_from_quaternion([FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0]);
/// assert!((angles.roll_rad.to_degrees() - 90.0).abs() < 1e-9);
/// ```
pub fn euler_from_quaternion(quaternion: [f64; 4]) -> EulerAngles {
    let [w, x, y, z] = unit(quaternion);
    EulerAngles {
        roll_rad: atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        // Rounding may lead outside the range of a sine.
        pitch_rad: asin(limit_abs(2.0 * (w * y - z * x), 1.0)),
        heading_rad: wrap_two_pi(atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))),
    }
}

/// The rotation `first`, and then `second` about the axes turned by it; of unit
/// length if both are.
///
/// ```
/// use core::f64::consts::FRAC_1_SQRT_2;
/// use fcc_core::flight::orientation::{euler_from_quaternion, product};
///
/// // A quarter of a turn to the right, then a bank of 90° to the right.
/// let east = [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];
/// let bank = [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0];
/// let angles = euler_from_quaternion(product(east, bank));
/// assert!((angles.roll_rad.to_degrees() - 90.0).abs() < 1e-9);
/// assert!((angles.heading_rad.to_degrees() - 90.0).abs() < 1e-9);
/// ```
pub fn product([a, b, c, d]: [f64; 4], [w, x, y, z]: [f64; 4]) -> [f64; 4] {
    [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]
}

/// Transforms a vector from body axes to earth axes.
///
/// ```
/// use core::f64::consts::FRAC_1_SQRT_2;
/// use fcc_core::flight::orientation::body_to_earth;
///
/// // The nose points east: so does what moves forward.
/// let east = [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];
/// let [north_mps, east_mps, _] = body_to_earth(east, [50.0, 0.0, 0.0]);
/// assert!(north_mps.abs() < 1e-9 && (east_mps - 50.0).abs() < 1e-9);
/// ```
pub fn body_to_earth(quaternion: [f64; 4], vector: [f64; 3]) -> [f64; 3] {
    turned(unit(quaternion), vector)
}

/// Transforms a vector from earth axes to body axes.
///
/// ```
/// use fcc_core::flight::orientation::{EulerAngles, earth_to_body, quaternion_from_euler};
///
/// // Gravity in a bank of 30° to the right: half of it acts to the right.
/// let bank = EulerAngles { roll_rad: 30.0_f64.to_radians(), ..EulerAngles::default() };
/// let [_, right, _] = earth_to_body(quaternion_from_euler(bank), [0.0, 0.0, 9.806_65]);
/// assert!((right - 4.903_325).abs() < 1e-9);
/// ```
pub fn earth_to_body(quaternion: [f64; 4], vector: [f64; 3]) -> [f64; 3] {
    let [w, x, y, z] = unit(quaternion);
    turned([w, -x, -y, -z], vector)
}

fn unit([w, x, y, z]: [f64; 4]) -> [f64; 4] {
    let length = sqrt(w * w + x * x + y * y + z * z);
    [w / length, x / length, y / length, z / length]
}

/// v + 2 q × (q × v + w v), q being the vector part.
fn turned([w, x, y, z]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        let ([ax, ay, az], [bx, by, bz]) = (a, b);
        [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
    };
    let q = [x, y, z];
    let [vx, vy, vz] = v;
    let [cx, cy, cz] = cross(q, v);
    let [dx, dy, dz] = cross(q, [cx + w * vx, cy + w * vy, cz + w * vz]);
    [vx + 2.0 * dx, vy + 2.0 * dy, vz + 2.0 * dz]
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn euler(roll_deg: f64, pitch_deg: f64, heading_deg: f64) -> EulerAngles {
        EulerAngles {
            roll_rad: roll_deg.to_radians(),
            pitch_rad: pitch_deg.to_radians(),
            heading_rad: heading_deg.to_radians(),
        }
    }

    fn near(found: &[f64], expected: &[f64]) {
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-12,
                "{found} is not {expected}"
            );
        }
    }

    /// The forward, right and down axes of the aircraft in north, east and
    /// down.
    #[test]
    fn axes_point_in_the_aircrafts_directions() {
        const FORWARD: [f64; 3] = [1.0, 0.0, 0.0];
        const RIGHT: [f64; 3] = [0.0, 1.0, 0.0];
        let turned = |angles, axis| body_to_earth(quaternion_from_euler(angles), axis);
        near(&turned(euler(0.0, 0.0, 90.0), FORWARD), &[0.0, 1.0, 0.0]);
        near(&turned(euler(0.0, 0.0, 90.0), RIGHT), &[-1.0, 0.0, 0.0]);
        near(&turned(euler(0.0, 90.0, 0.0), FORWARD), &[0.0, 0.0, -1.0]);
        near(&turned(euler(90.0, 0.0, 0.0), RIGHT), &[0.0, 0.0, 1.0]);
        // Nose 30° up on heading 60°: cos 30° is horizontal, one half is up.
        let level = 3.0_f64.sqrt() / 2.0;
        near(
            &turned(euler(0.0, 30.0, 60.0), FORWARD),
            &[0.5 * level, level * level, -0.5],
        );
    }

    /// In an aircraft banked by 60° gravity acts by sin 60° to the right and
    /// cos 60° down.
    #[test]
    fn gravity_in_body_axes() {
        let banked = quaternion_from_euler(euler(60.0, 0.0, 137.0));
        near(
            &earth_to_body(banked, [0.0, 0.0, 9.80665]),
            &[0.0, 9.80665 * 3.0_f64.sqrt() / 2.0, 9.80665 / 2.0],
        );
    }

    /// Half turns, by hand: a roll of 180° is [0, 1, 0, 0].
    #[test]
    fn half_turns() {
        near(
            &quaternion_from_euler(euler(180.0, 0.0, 0.0)),
            &[0.0, 1.0, 0.0, 0.0],
        );
        near(
            &quaternion_from_euler(euler(0.0, 0.0, 180.0)),
            &[0.0, 0.0, 0.0, 1.0],
        );
        let turned = euler_from_quaternion([0.0, 0.0, 0.0, 2.0]);
        assert!((turned.heading_rad - PI).abs() < 1e-12);
    }

    #[test]
    fn angles_are_restored() {
        for roll in [-170.0, -35.0, 0.0, 80.0] {
            for pitch in [-85.0, -10.0, 0.0, 60.0] {
                for heading in [0.0, 1.0, 179.0, 181.0, 359.0] {
                    let angles = euler(roll, pitch, heading);
                    let back = euler_from_quaternion(quaternion_from_euler(angles));
                    near(
                        &[back.roll_rad, back.pitch_rad, back.heading_rad],
                        &[angles.roll_rad, angles.pitch_rad, angles.heading_rad],
                    );
                }
            }
        }
    }

    #[test]
    fn straight_up_stays_within_the_range_of_a_pitch() {
        let up = euler_from_quaternion(quaternion_from_euler(euler(20.0, 90.0, 50.0)));
        assert!((up.pitch_rad - FRAC_PI_2).abs() < 1e-7);
    }

    #[test]
    fn a_quaternion_of_length_zero_gives_nan() {
        assert!(euler_from_quaternion([0.0; 4]).pitch_rad.is_nan());
    }
}
