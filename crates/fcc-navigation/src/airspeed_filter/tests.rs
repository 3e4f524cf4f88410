use libm::{cos, sin};

use super::super::airframe::LearnedAirframe;
use super::super::force_sample::acceleration_mps2;
use super::super::upward::Upward;
use super::*;

const PRIOR: AirframePrior = AirframePrior {
    reference_mps: 51.444,
    full_thrust_ratio: 0.25,
    learned: None,
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

/// The filter learns the aircraft in level flight and in a turn with 45° of bank; then, 15 kt off, without
/// a sensor in a turn with 60° of bank, lift and drag take it back in a minute and a half:
/// their errors last for seconds.
#[test]
fn the_airspeed_is_found_in_a_turn_with_60_degrees_of_bank() {
    let level = level_turn(0.0);
    let mut filter = AirspeedFilter::new(PRIOR, (51.444, 1.0), &level);
    for bank_deg in [0.0, 45.0, 0.0, 45.0] {
        let learns = level_turn(bank_deg);
        for _ in 0..600 {
            filter.correct(&learns, 0.1);
            filter.correct_by_sensor(51.444);
        }
    }
    let turn = level_turn(60.0);
    let mut filter = filter.kept();
    filter.adopt(51.444 - 7.7);
    filter.without_models(10.0);
    for _ in 0..900 {
        filter.accelerate(acceleration_mps2(&turn, filter.airspeed_mps()), 0.1);
        filter.correct(&turn, 0.1);
    }
    assert!(
        (filter.airspeed_mps() - 51.444).abs() < 2.0,
        "{}",
        filter.airspeed_mps()
    );
}

/// Of the aircraft above: without lift at no angle; its drag at half throttle, 0.125, 0.09
/// and 0.02 of the weight, leaves that offset.
const LEARNED: LearnedAirframe = LearnedAirframe {
    axial_offset: -0.015,
    full_thrust_ratio: 0.25,
    zero_lift_angle_rad: 0.0,
    one_g_angle_rad: LIFT_ANGLE_RAD,
};

/// 20 kt wrong at first, in level flight and in a turn, without any sensor.
#[test]
fn a_learned_aircraft_shows_its_airspeed_without_a_sensor() {
    for (bank_deg, begins_mps) in [(0.0, 41.2), (0.0, 61.7), (30.0, 61.7)] {
        let sample = level_turn(bank_deg);
        let prior = AirframePrior {
            learned: Some(LEARNED),
            ..PRIOR
        };
        let mut filter = AirspeedFilter::new(prior, (begins_mps, 7.0), &sample);
        for _ in 0..600 {
            filter.accelerate(acceleration_mps2(&sample, filter.airspeed_mps()), 0.1);
            filter.correct(&sample, 0.1);
        }
        let error_mps = filter.airspeed_mps() - 51.444;
        assert!(error_mps.abs() < 1.5, "{bank_deg}: {error_mps}");
        assert!(error_mps.abs() < filter.sd_mps(), "{bank_deg}");
    }
}
