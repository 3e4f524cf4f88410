//! Inertial sensors whose biases drift in flight.

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::orientation::euler_from_quaternion;

use super::flight::Flight;
use super::sensors::{Fitted, Run};

const DRIFTS_S: f64 = 60.0;
/// Wrong by more than this is the attitude lost, °.
const LOST_DEG: f64 = 10.0;

/// Turns to the left and to the right by 25° of bank, in between straight flight.
fn turns(time_s: f64) -> (f64, f64, f64) {
    let share = (time_s / 15.0).sin();
    (25.0_f64.to_radians() * share * share * share, 0.0, 50.0)
}

/// The largest error of roll and pitch in two minutes of a drift, °, in severe turbulence.
fn largest_error(rate: [f64; 3], force: [f64; 3], seed: u64) -> f64 {
    let fitted = Fitted {
        drifts: (rate.map(f64::to_radians), force, DRIFTS_S),
        ..Fitted::default()
    };
    let flight = Flight::new(turns, 1.0, [-6.0, 8.0]).in_turbulence(seed);
    let mut run = Run::new(flight, fitted, seed);
    let mut largest = 0.0_f64;
    run.until(DRIFTS_S, |_, _| {});
    run.until(DRIFTS_S + 120.0, |truth, solution| {
        let found = euler_from_quaternion(solution.quaternion);
        let roll = wrap_pi(found.roll_rad - truth.angles.roll_rad);
        let pitch = found.pitch_rad - truth.angles.pitch_rad;
        largest = largest.max(roll.abs()).max(pitch.abs());
    });
    largest.to_degrees()
}

#[test]
fn a_gyroscope_that_drifts_is_followed_with_a_receiver() {
    for rate in [[0.05, 0.0, 0.0], [0.0, 0.05, 0.0], [0.0, -0.05, 0.0]] {
        let error = largest_error(rate, [0.0; 3], 21);
        assert!(error <= LOST_DEG, "{error}° with {rate:?} °/s²");
    }
}

#[test]
fn an_accelerometer_that_drifts_is_followed_with_a_receiver() {
    for force in [[0.03, 0.0, 0.0], [0.0, 0.03, 0.0]] {
        let error = largest_error([0.0; 3], force, 23);
        assert!(error <= LOST_DEG, "{error}° with {force:?} m/s³");
    }
}

/// The power of take-off shakes an accelerometer, which then shows another mean (vibration
/// rectification). That is no pitch, with a receiver or without: 2° is a quarter of the 8°
/// at which a Cessna 172 climbs away.
#[test]
fn a_vertical_accelerometer_that_is_shaken_tips_no_horizon_in_a_take_off() {
    /// Stands for 20 s, accelerates by 2 m/s² and climbs.
    fn takes_off(time_s: f64) -> (f64, f64, f64) {
        let airspeed = (2.0 * (time_s - 20.0)).clamp(0.0, 40.0);
        (0.0, 0.01 * (time_s - 38.0).clamp(0.0, 8.0), airspeed)
    }
    for (off, most_deg) in [(0.5, 2.0), (-0.5, 2.0), (1.0, 4.0)] {
        for receiver in [true, false] {
            let fitted = Fitted {
                receiver,
                force_jumps: ([0.0, 0.0, off], 20.0),
                ..Fitted::default()
            };
            let mut run = Run::new(Flight::new(takes_off, 1.0, [0.0; 2]), fitted, 27);
            let mut pitch_rad = 0.0_f64;
            run.until(60.0, |truth, solution| {
                if truth.time_s > 20.0 {
                    let found = euler_from_quaternion(solution.quaternion);
                    pitch_rad = pitch_rad.max((found.pitch_rad - truth.angles.pitch_rad).abs());
                }
            });
            let error = pitch_rad.to_degrees();
            assert!(
                error <= most_deg,
                "{error}° with {off} m/s², receiver {receiver}"
            );
        }
    }
}
