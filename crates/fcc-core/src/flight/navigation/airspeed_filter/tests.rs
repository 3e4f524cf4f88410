use libm::{cos, sin};

use super::super::force_sample::acceleration_mps2;
use super::super::upward::Upward;
use super::*;

const PRIOR: AirframePrior = AirframePrior {
    reference_mps: 51.444,
    full_thrust_ratio: 0.25,
};

fn rad(deg: f64) -> f64 {
    deg.to_radians()
}

/// Level turns of an aircraft with the prior's lift and drag at the prior's
/// airspeed: n = 1/cos φ (FAA-H-8083-25B, chapter 5), and sin θ = tan α cos φ.
fn level_turn(bank_deg: f64) -> ForceSample {
    let load = 1.0 / cos(rad(bank_deg));
    // The lift is perpendicular to the path, the drag balanced by thrust.
    let alpha = LIFT_ANGLE_RAD * load;
    let pitch_rad = libm::atan(libm::tan(alpha) * cos(rad(bank_deg)));
    ForceSample {
        forward: load * sin(alpha),
        up: load * cos(alpha),
        pitch_rad,
        roll_rad: rad(bank_deg),
        upward: Upward::of(rad(bank_deg), pitch_rad),
        sqrt_density: 1.0,
        thrust: Some((0.5, 0.0)),
        ..ForceSample::NONE
    }
}

#[test]
fn a_turn_with_60_degrees_of_bank_is_no_acceleration() {
    for bank_deg in [0.0, 30.0, 60.0, -60.0] {
        let sample = level_turn(bank_deg);
        assert!(
            acceleration_mps2(&sample, 51.444).abs() < 0.01,
            "{bank_deg}"
        );
    }
}

/// Inverted and level, nose 8° above the horizon, the wing at α = -8° with
/// -1 g: no acceleration either, but for drag, which thrust balances.
#[test]
fn the_angle_of_attack_is_right_inverted() {
    let inverted = Upward::of(rad(180.0), rad(8.0));
    let alpha = inverted.angle_of_attack_rad(0.0);
    assert!((alpha - rad(-8.0)).abs() < 1e-9);
    let descending = inverted.angle_of_attack_rad(sin(rad(-3.0)));
    assert!((descending - rad(-11.0)).abs() < 1e-9);
}

/// The filter learns the aircraft in level flight; then, 15 kt off, without
/// a sensor in a turn with 60° of bank, lift and drag take it back.
#[test]
fn the_airspeed_is_found_in_a_turn_with_60_degrees_of_bank() {
    let level = level_turn(0.0);
    let mut filter = AirspeedFilter::new(PRIOR, 51.444, &level);
    for _ in 0..300 {
        filter.correct(&level, 0.1);
        filter.correct_by_sensor(51.444);
    }
    let turn = level_turn(60.0);
    filter.adopt(51.444 - 7.7);
    filter.without_models(10.0);
    for _ in 0..300 {
        filter.accelerate(acceleration_mps2(&turn, filter.airspeed_mps()), 0.1);
        filter.correct(&turn, 0.1);
    }
    assert!(
        (filter.airspeed_mps() - 51.444).abs() < 2.0,
        "{}",
        filter.airspeed_mps()
    );
}
