//! Attitude: from a thrust vector and a heading to turn rates.

use core::f64::consts::FRAC_PI_3;

use fcc_core::blocks::wrap_pi;
use libm::{atan2, cos, sin};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// The share of the heading error that the target contains; its gain is larger by as much.
const YAW_WEIGHT: f64 = 0.4;
/// Beyond this error of the thrust's direction the heading waits.
const HEADING_WAITS_RAD: f64 = FRAC_PI_3;

/// The attitude whose thrust points along `thrust` (north, east, down; not zero) and whose nose
/// points along a heading, rad.
pub fn attitude_of_thrust(thrust: &Vector3<f64>, heading_rad: f64) -> UnitQuaternion<f64> {
    let down = -thrust.normalize();
    // Level, and square to the heading: the nose is in the vertical plane of the heading.
    let level = Vector3::new(-sin(heading_rad), cos(heading_rad), 0.0);
    // Where the thrust is level and to the side, any nose is as good.
    let ahead = level
        .cross(&down)
        .try_normalize(1e-6)
        .unwrap_or_else(Vector3::z);
    let axes = Matrix3::from_columns(&[ahead, down.cross(&ahead), down]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}

/// The turn rates, body axes, rad/s, from an attitude to a wanted one, by gains in 1/s: the
/// direction of the thrust first, and the heading as far as it does not hinder (Brescianini,
/// Hehn and D'Andrea 2013, eq. 20 to 23).
pub fn rates_to(
    wanted: &UnitQuaternion<f64>,
    attitude: &UnitQuaternion<f64>,
    gain: &Vector3<f64>,
) -> Vector3<f64> {
    let (down, wanted_down) = (attitude * Vector3::z(), wanted * Vector3::z());
    let tilt = UnitQuaternion::rotation_between(&down, &wanted_down).unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&(attitude * Vector3::x_axis()), core::f64::consts::PI)
    });
    let reduced = tilt * attitude;
    let turn = reduced.inverse() * wanted;
    let heading_error_rad = wrap_pi(2.0 * atan2(turn.k, turn.w));
    let weight = if tilt.angle() > HEADING_WAITS_RAD {
        0.0
    } else {
        YAW_WEIGHT
    };
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), weight * heading_error_rad);
    let error = attitude.inverse() * reduced * yaw;
    let sign = if error.w < 0.0 { -2.0 } else { 2.0 };
    let gain = Vector3::new(gain.x, gain.y, gain.z / YAW_WEIGHT);
    error.imag().component_mul(&gain) * sign
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAIN: Vector3<f64> = Vector3::new(4.0, 4.0, 2.8);

    fn euler(roll_deg: f64, pitch_deg: f64, heading_deg: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_euler_angles(
            roll_deg.to_radians(),
            pitch_deg.to_radians(),
            heading_deg.to_radians(),
        )
    }

    /// At 45° to the north-east thrust is tilted about both axes; by hand for a heading of 0:
    /// forward acceleration lowers the nose, and one to the right lowers the right side.
    #[test]
    fn thrust_tilts_the_body_towards_itself() {
        let attitude = attitude_of_thrust(&Vector3::new(1.0, 0.0, -1.0), 0.0);
        assert!(attitude.angle_to(&euler(0.0, -45.0, 0.0)) < 1e-9);
        let attitude = attitude_of_thrust(&Vector3::new(0.0, 1.0, -1.0), 0.0);
        assert!(attitude.angle_to(&euler(45.0, 0.0, 0.0)) < 1e-9);
        let attitude = attitude_of_thrust(&Vector3::new(-3.0, 5.0, -6.0), 0.7);
        assert!((attitude.euler_angles().2 - 0.7).abs() < 1e-9);
        let attitude = attitude_of_thrust(&Vector3::new(0.0, 0.0, -9.8), 2.0);
        assert!(attitude.angle_to(&euler(0.0, 0.0, 2.0_f64.to_degrees())) < 1e-9);
    }

    /// Small errors give gain times angle on each axis.
    #[test]
    fn small_errors_are_proportional() {
        for (axis, wanted) in [
            euler(0.5, 0.0, 30.0),
            euler(0.0, 0.5, 30.0),
            euler(0.0, 0.0, 30.5),
        ]
        .into_iter()
        .enumerate()
        {
            let rates = rates_to(&wanted, &euler(0.0, 0.0, 30.0), &GAIN);
            let expected = GAIN[axis] * 0.5_f64.to_radians();
            assert!((rates[axis] - expected).abs() < 1e-4, "{axis}: {rates}");
            assert!((rates.norm() - expected).abs() < 1e-4, "{axis}: {rates}");
        }
    }

    /// A tilt with a large heading error turns about the axis that rights it, and the heading
    /// waits; the shorter way is taken from the other sign of the quaternion, too.
    #[test]
    fn tilt_comes_before_heading() {
        let attitude = euler(70.0, 0.0, 0.0);
        let rates = rates_to(&euler(0.0, 0.0, 150.0), &attitude, &GAIN);
        assert!(
            rates.x < -2.0 && rates.y.abs() < 1e-9 && rates.z.abs() < 1e-9,
            "{rates}"
        );
        let negative = UnitQuaternion::new_unchecked(-attitude.into_inner());
        let again = rates_to(&euler(0.0, 0.0, 150.0), &negative, &GAIN);
        assert!((again - rates).norm() < 1e-9);
        // Upside down: it turns about some axis, and not by a number that is none.
        let rates = rates_to(&euler(0.0, 0.0, 0.0), &euler(180.0, 0.0, 0.0), &GAIN);
        assert!(rates.norm() > 4.0, "{rates}");
    }
}
