//! Specific force, as accelerometers measure it, from X-Plane's accelerations.
//!
//! `local_ax/ay/az` are the acceleration of the aircraft over the ground in
//! X-Plane's local axes (x east, y up, z south), without gravity: 0 in steady
//! level flight. Specific force is that acceleration minus gravity, in body
//! axes: f = Rᵀ a - g, with R the rotation from body to local axes and g gravity
//! in body axes. Gravity points down below the aircraft, not along the local
//! axes, which belong to a point up to some tens of kilometres away: so it needs
//! the true pitch and roll.
//!
//! `g_axil` and `g_side` are not used: sources do not state, or disagree on,
//! their sign and whether they include the component of gravity along their
//! axis. The definition above is unambiguous. Rows of Data Output have only the
//! load factors, so these are used there, see [`rows`](crate::rows).

use fcc_core::flight::{Attitude, SpecificForce};

use crate::units::GRAVITY_MPS2;

/// Specific force from the acceleration over the ground in X-Plane's axes
/// (east, up, south; m/s²), the attitude in these axes (heading, pitch, roll;
/// rad), and the attitude at the place of the aircraft.
///
/// The rotation is the z-y-x Euler sequence (Stevens, Lewis and Johnson,
/// Aircraft Control and Simulation, 3rd ed. 2016, section 1.3).
pub(crate) fn specific_force(
    [east, up, south]: [f64; 3],
    [heading_rad, pitch_rad, roll_rad]: [f64; 3],
    attitude: Attitude,
) -> SpecificForce {
    let (north, down) = (-south, -up);
    let (sin_heading, cos_heading) = heading_rad.sin_cos();
    // One rotation at a time: heading about z, pitch about y, roll about x.
    let ahead = cos_heading * north + sin_heading * east;
    let across = cos_heading * east - sin_heading * north;
    let [forward, right, below] = tilted([ahead, across, down], pitch_rad, roll_rad);
    let gravity = [0.0, 0.0, GRAVITY_MPS2];
    let [x, y, z] = tilted(gravity, attitude.pitch_rad, attitude.roll_rad);
    SpecificForce {
        x_mps2: forward - x,
        y_mps2: right - y,
        z_mps2: below - z,
    }
}

/// A vector ahead, to the right and down, in the axes of a body with this pitch
/// and roll.
fn tilted([ahead, across, down]: [f64; 3], pitch_rad: f64, roll_rad: f64) -> [f64; 3] {
    let (sin_pitch, cos_pitch) = pitch_rad.sin_cos();
    let (sin_roll, cos_roll) = roll_rad.sin_cos();
    let forward = cos_pitch * ahead - sin_pitch * down;
    let below = sin_pitch * ahead + cos_pitch * down;
    [
        forward,
        cos_roll * across + sin_roll * below,
        cos_roll * below - sin_roll * across,
    ]
}

#[cfg(test)]
mod tests {
    use fcc_core::flight::{Attitude, SpecificForce};

    use crate::units::GRAVITY_MPS2;

    /// Where the local axes are those of the place.
    fn specific_force(accelerations: [f64; 3], angles: [f64; 3]) -> SpecificForce {
        let [_, pitch_rad, roll_rad] = angles;
        let attitude = Attitude {
            pitch_rad,
            roll_rad,
        };
        super::specific_force(accelerations, angles, attitude)
    }

    fn close(force: SpecificForce, expected: [f64; 3]) {
        let got = [force.x_mps2, force.y_mps2, force.z_mps2];
        for (got, expected) in got.into_iter().zip(expected) {
            assert!((got - expected).abs() < 1e-3, "{force:?} is not {expected}");
        }
    }

    #[test]
    fn steady_level_flight_gives_one_g_upwards() {
        close(
            specific_force([0.0; 3], [1.0, 0.0, 0.0]),
            [0.0, 0.0, -9.80665],
        );
    }

    /// A coordinated level turn at 60° of bank loads an aircraft with 2 g
    /// (FAA-H-8083-25C, chapter 5), along its own z axis and nowhere else. To
    /// the right while heading north it accelerates east with g·tan 60° =
    /// 16.986 m/s²; heading east, south.
    #[test]
    fn a_coordinated_turn_at_sixty_degrees_is_two_g() {
        let bank = 60.0_f64.to_radians();
        let two_g = [0.0, 0.0, -19.6133];
        close(specific_force([16.9856, 0.0, 0.0], [0.0, 0.0, bank]), two_g);
        let east = 90.0_f64.to_radians();
        close(
            specific_force([0.0, 0.0, 16.9856], [east, 0.0, bank]),
            two_g,
        );
    }

    /// At rest with the nose 30° up an accelerometer along x reads half a g
    /// forward: sin 30° = 1/2.
    #[test]
    fn a_raised_nose_gives_a_forward_component_of_gravity() {
        let nose = 30.0_f64.to_radians();
        close(
            specific_force([0.0; 3], [2.0, nose, 0.0]),
            [4.9033, 0.0, -8.4928],
        );
    }

    #[test]
    fn a_forward_acceleration_gives_a_forward_force() {
        // Heading south, 2 m/s² towards south.
        let south = core::f64::consts::PI;
        close(
            specific_force([0.0, 0.0, 2.0], [south, 0.0, 0.0]),
            [2.0, 0.0, -9.80665],
        );
    }

    #[test]
    fn free_fall_gives_no_force() {
        close(
            specific_force([0.0, -9.80665, 0.0], [0.3, -0.2, 1.0]),
            [0.0; 3],
        );
    }

    /// Level flight where the local axes lean by 1°: an accelerometer measures
    /// gravity along the aircraft's z, and the sine of 1° of it nowhere.
    #[test]
    fn tilted_local_axes_do_not_move_gravity() {
        let lean = 1.0_f64.to_radians();
        let level = Attitude::default();
        let force = super::specific_force([0.0; 3], [0.5, lean, -lean], level);
        close(force, [0.0, 0.0, -GRAVITY_MPS2]);
    }
}
