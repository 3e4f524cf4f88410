//! Angles on the circle.

use core::f64::consts::{PI, TAU};

use libm::floor;

/// The same angle in -π..π (π itself becomes -π), rad.
///
/// ```
/// use core::f64::consts::PI;
/// let turn_left = fcc_core::blocks::wrap_pi(1.5 * PI);
/// assert!((turn_left + 0.5 * PI).abs() < 1e-12);
/// ```
pub fn wrap_pi(angle_rad: f64) -> f64 {
    angle_rad - TAU * floor((angle_rad + PI) / TAU)
}

/// The same angle in 0..2π, rad, as on a compass.
///
/// ```
/// use core::f64::consts::FRAC_PI_2;
/// let west = fcc_core::blocks::wrap_two_pi(-FRAC_PI_2);
/// assert!((west.to_degrees() - 270.0).abs() < 1e-9);
/// ```
pub fn wrap_two_pi(angle_rad: f64) -> f64 {
    let wrapped = angle_rad - TAU * floor(angle_rad / TAU);
    // A tiny negative angle rounds up to a full turn.
    if wrapped >= TAU { 0.0 } else { wrapped }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn north_is_zero_from_either_side() {
        assert_eq!(wrap_two_pi(0.0), 0.0);
        assert_eq!(wrap_two_pi(-1e-18), 0.0);
        assert_eq!(wrap_two_pi(TAU), 0.0);
        assert!((wrap_two_pi(-0.1) - (TAU - 0.1)).abs() < 1e-15);
    }

    #[test]
    fn differences_take_the_shorter_way() {
        // 350° to 10° is 20° to the right.
        let error = wrap_pi((10.0_f64 - 350.0).to_radians());
        assert!((error.to_degrees() - 20.0).abs() < 1e-12);
        assert_eq!(wrap_pi(PI), -PI);
    }
}
