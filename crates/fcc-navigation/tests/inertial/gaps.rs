//! Gyroscopes and accelerometers that are both lost for a while in a turn.

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::orientation::euler_from_quaternion;

use super::flight::{Flight, Manoeuvre};
use super::sensors::{Fitted, Run};

const LOST_S: f64 = 40.0;
/// The horizon is right again after the time for which a failsafe without an attitude holds
/// control, s: to 5°, a sixth of the bank.
const RIGHT_AGAIN_S: f64 = 5.0;
const RIGHT_DEG: f64 = 5.0;
/// The delay of the filter, and the interval of the receiver, s: so late is a loss noticed.
const NOTICED_S: f64 = 0.4;

/// 30° of bank from the twentieth second on: a turn of 6.5 °/s at 50 m/s.
fn bank(time_s: f64) -> f64 {
    30.0_f64.to_radians() * ((time_s - 20.0) / 3.0).clamp(0.0, 1.0)
}

fn right(time_s: f64) -> (f64, f64, f64) {
    (bank(time_s), 0.0, 50.0)
}

fn left(time_s: f64) -> (f64, f64, f64) {
    (-bank(time_s), 0.0, 50.0)
}

/// As slow as turns by 13 °/s.
fn tight(time_s: f64) -> (f64, f64, f64) {
    (bank(time_s), 0.0, 25.0)
}

/// From the left to the right while nothing is seen of it.
fn reversed(time_s: f64) -> (f64, f64, f64) {
    let share = ((time_s - LOST_S - 2.0) / 3.0).clamp(-1.0, 1.0);
    (bank(time_s) * share, 0.0, 50.0)
}

/// When the horizon is within 5° for good, s after the loss, and the largest error of roll,
/// pitch and heading, as a number of standard deviations.
fn lost_for(gap_s: f64, manoeuvre: Manoeuvre, fitted: Fitted, seed: u64) -> (f64, f64) {
    let back_s = LOST_S + gap_s;
    let fitted = Fitted {
        inertial_lost_s: (LOST_S, back_s),
        ..fitted
    };
    let flight = Flight::new(manoeuvre, seed as f64, [-6.0, 8.0]);
    let mut run = Run::new(flight, fitted, seed);
    run.until(LOST_S + NOTICED_S, |_, _| {});
    let (mut right_s, mut deviations) = (0.0_f64, 0.0_f64);
    run.until(back_s + 20.0, |truth, solution| {
        let found = euler_from_quaternion(solution.quaternion);
        let (expected, sigma) = (truth.angles, solution.sigma);
        let roll = wrap_pi(found.roll_rad - expected.roll_rad).abs();
        let pitch = (found.pitch_rad - expected.pitch_rad).abs();
        let heading = wrap_pi(found.heading_rad - expected.heading_rad).abs();
        if roll.max(pitch).to_degrees() > RIGHT_DEG {
            right_s = truth.time_s - back_s;
        }
        deviations = deviations
            .max(roll / sigma.roll_rad)
            .max(pitch / sigma.pitch_rad)
            .max(heading / sigma.heading_rad);
    });
    (right_s, deviations)
}

fn is_found_again(gap_s: f64) {
    let manoeuvres: [Manoeuvre; 4] = [right, left, tight, reversed];
    for (compass, airspeed) in [(true, true), (true, false), (false, true), (false, false)] {
        let fitted = Fitted {
            compass,
            airspeed,
            ..Fitted::default()
        };
        for (at, manoeuvre) in manoeuvres.into_iter().enumerate() {
            for seed in 1..=3 {
                let (right_s, deviations) = lost_for(gap_s, manoeuvre, fitted, seed);
                let of = format!("{at}, compass {compass}, airspeed {airspeed}, seed {seed}");
                assert!(right_s <= RIGHT_AGAIN_S, "{right_s} s of manoeuvre {of}");
                assert!(deviations <= 3.0, "{deviations} sigmas of manoeuvre {of}");
            }
        }
    }
}

#[test]
fn the_horizon_is_found_again_after_a_second_or_three_without_inertial_sensors() {
    is_found_again(1.0);
    is_found_again(3.0);
}

#[test]
fn the_horizon_is_found_again_after_ten_seconds_without_inertial_sensors() {
    is_found_again(10.0);
}

#[test]
fn the_horizon_is_found_again_after_thirty_seconds_without_inertial_sensors() {
    is_found_again(30.0);
}
