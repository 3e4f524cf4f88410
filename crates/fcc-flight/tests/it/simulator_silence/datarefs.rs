//! The aircraft's motion as X-Plane's datarefs have it.

use fcc_sim::Truth;

/// The value of the dataref with this name, the last part of its path; none if no such is known.
pub(crate) fn of(truth: &Truth, name: &str) -> Option<f64> {
    let [north, east, down] = acceleration_mps2(truth);
    Some(match name {
        "theta" | "true_theta" => truth.pitch_rad.to_degrees(),
        "phi" | "true_phi" => truth.roll_rad.to_degrees(),
        "psi" | "mag_psi" | "true_psi" => truth.heading_rad.to_degrees(),
        "Prad" => truth.rates.roll_radps,
        "Qrad" => truth.rates.pitch_radps,
        "Rrad" => truth.rates.yaw_radps,
        "local_ax" => east,
        "local_ay" => -down,
        "local_az" => -north,
        "local_vx" => truth.velocity.east_mps,
        "local_vy" => -truth.velocity.down_mps,
        "local_vz" => -truth.velocity.north_mps,
        "indicated_airspeed" => truth.indicated_airspeed_mps / 0.514_444_444,
        "altitude_ft_pilot" | "pressure_altitude" => truth.altitude_m / 0.304_8,
        "alpha" => truth.angle_of_attack_rad.to_degrees(),
        _ => return None,
    })
}

/// North, east, down: the specific force from body axes (Stevens, Lewis and Johnson 2016,
/// equation 1.4-5), and gravity.
fn acceleration_mps2(truth: &Truth) -> [f64; 3] {
    let (sin_roll, cos_roll) = truth.roll_rad.sin_cos();
    let (sin_pitch, cos_pitch) = truth.pitch_rad.sin_cos();
    let (sin_heading, cos_heading) = truth.heading_rad.sin_cos();
    let force = truth.specific_force;
    let side = force.y_mps2 * cos_roll - force.z_mps2 * sin_roll;
    let below = force.y_mps2 * sin_roll + force.z_mps2 * cos_roll;
    let ahead = force.x_mps2 * cos_pitch + below * sin_pitch;
    [
        ahead * cos_heading - side * sin_heading,
        ahead * sin_heading + side * cos_heading,
        below * cos_pitch - force.x_mps2 * sin_pitch + 9.806_65,
    ]
}
