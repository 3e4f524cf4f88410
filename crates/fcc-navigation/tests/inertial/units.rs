//! Several inertial units, of which one fails: chosen as the loop does it.

use std::time::Duration;

use fcc_core::flight::orientation::{earth_to_body, euler_from_quaternion};
use fcc_core::flight::{BodyRates, Measurements};
use fcc_core::framework::Reading;
use fcc_navigation::inertial::{MagneticNorth, RawNavigation, RawNavigationConfig};

use super::chosen::chosen;
use super::flight::Flight;
use super::gyroscope::readings;
use super::noise::Random;
use super::sensors::{FIELD_UT, time};

const TICK_S: f64 = 0.025;
const FAILS_S: f64 = 30.0;
const FRESH_FOR: Duration = Duration::from_millis(100);

/// What unit fails in, from 30 s on: its readings, its number, and its rates at the
/// failure.
type Fault = fn(&mut Measurements, usize, BodyRates);

/// Turns to the left and to the right by 25° of bank.
fn turns(time_s: f64) -> (f64, f64, f64) {
    let share = (time_s / 10.0 * std::f64::consts::PI).sin();
    (25.0_f64.to_radians() * share * share * share, 0.0, 50.0)
}

/// What came of a flight.
struct Flown {
    /// When another unit was used than before, after the fault began, and which.
    changes: Vec<(f64, u8)>,
    /// The largest error of roll, degrees, from 5 s after the fault on.
    roll_deg: f64,
    doubted_at_the_end: bool,
}

/// Flies for 90 s with so many units, whose gyroscopes have biases of their own.
fn fly(units: usize, fault: Fault) -> Flown {
    let mut flight = Flight::new(turns, 0.5, [4.0, -3.0]);
    let mut random = Random::new(7);
    let mut navigation = RawNavigation::new(RawNavigationConfig {
        delay: Duration::from_millis(150),
        north: MagneticNorth::Field(FIELD_UT),
    });
    let mut kept = vec![None; units];
    let mut used = 0;
    let mut flown = Flown {
        changes: Vec::new(),
        roll_deg: 0.0,
        doubted_at_the_end: false,
    };
    for tick in 0_u32.. {
        flight.step(TICK_S);
        let truth = flight.now;
        if truth.time_s > 90.0 {
            break;
        }
        let now = time(truth.time_s);
        let noise = random.vector(0.6);
        let field = earth_to_body(truth.quaternion, FIELD_UT);
        let field = [0, 1, 2].map(|axis| field[axis] + noise[axis]);
        let given: Vec<Measurements> = (0..units)
            .map(|unit| {
                let noise = random.vector(0.002);
                let bias = 0.005 * (unit as f64 - 1.0);
                let rates = [0, 1, 2].map(|axis| truth.rates[axis] + bias + noise[axis]);
                let mut measured = readings(&truth, now, rates, field, tick % 8 == 0);
                if truth.time_s >= FAILS_S {
                    let at_first = *kept[unit].get_or_insert(measured.raw_body_rates.value);
                    fault(&mut measured, unit, at_first);
                }
                measured
            })
            .collect();
        let measured = chosen(now, &given, FRESH_FOR, &mut navigation);
        navigation.step(now, &measured);
        let since_s = truth.time_s - FAILS_S;
        if measured.raw_body_rates.source != used {
            used = measured.raw_body_rates.source;
            flown.changes.push((since_s, used));
        }
        flown.doubted_at_the_end = navigation.doubts_gyroscopes();
        if since_s > 5.0 {
            let found = navigation.found().attitude.value.roll_rad;
            let roll = euler_from_quaternion(truth.quaternion).roll_rad;
            flown.roll_deg = flown.roll_deg.max((found - roll).to_degrees().abs());
        }
    }
    flown
}

/// Of these units roll is inverted.
fn inverted(bad: &[usize], measured: &mut Measurements, unit: usize) {
    if bad.contains(&unit) {
        measured.raw_body_rates.value.roll_radps *= -1.0;
    }
}

#[test]
fn the_first_of_two_that_is_wrong_is_left_within_seconds() {
    let flown = fly(2, |measured, unit, _| inverted(&[0], measured, unit));
    let &[(at_s, 1)] = &flown.changes[..] else {
        panic!("{:?}", flown.changes)
    };
    assert!((0.2..5.0).contains(&at_s), "{at_s}");
    assert!(!flown.doubted_at_the_end);
    assert!(flown.roll_deg < 5.0, "{}", flown.roll_deg);
}

/// Put into its socket the wrong way round, and with two wires or keys exchanged.
#[test]
fn one_that_is_turned_or_has_swapped_axes_is_left() {
    let turned: Fault = |measured, unit, _| {
        if unit == 0 {
            let rates = &mut measured.raw_body_rates.value;
            rates.roll_radps *= -1.0;
            rates.pitch_radps *= -1.0;
            let force = &mut measured.raw_specific_force.value;
            force.x_mps2 *= -1.0;
            force.y_mps2 *= -1.0;
        }
    };
    let swapped: Fault = |measured, unit, _| {
        if unit == 0 {
            let rates = &mut measured.raw_body_rates.value;
            std::mem::swap(&mut rates.roll_radps, &mut rates.yaw_radps);
        }
    };
    for fault in [turned, swapped] {
        let flown = fly(2, fault);
        let &[(at_s, 1)] = &flown.changes[..] else {
            panic!("{:?}", flown.changes)
        };
        assert!((0.2..5.0).contains(&at_s), "{at_s}");
        assert!(!flown.doubted_at_the_end);
        assert!(flown.roll_deg < 5.0, "{}", flown.roll_deg);
    }
}

#[test]
fn of_three_the_first_two_that_are_wrong_are_left_one_after_the_other() {
    let flown = fly(3, |measured, unit, _| inverted(&[0, 1], measured, unit));
    let &[(first_s, 1), (second_s, 2)] = &flown.changes[..] else {
        panic!("{:?}", flown.changes)
    };
    assert!(first_s < 5.0 && second_s < 12.0, "{first_s} {second_s}");
    assert!(!flown.doubted_at_the_end);
}

#[test]
fn one_that_repeats_itself_is_left() {
    let flown = fly(2, |measured, unit, at_first| {
        if unit == 0 {
            measured.raw_body_rates.value = at_first;
        }
    });
    let &[(at_s, 1)] = &flown.changes[..] else {
        panic!("{:?}", flown.changes)
    };
    assert!((0.4..3.0).contains(&at_s), "{at_s}");
    assert!(flown.roll_deg < 3.0, "{}", flown.roll_deg);
}

/// Silent for half a second, it would be used again by its place in the order.
#[test]
fn one_that_was_left_is_not_used_again_when_it_returns() {
    let flown = fly(2, |measured, unit, _| {
        let silent = measured.raw_body_rates.taken < time(FAILS_S + 0.5);
        if unit == 0 && silent {
            measured.raw_body_rates = Reading::default();
            measured.raw_specific_force = Reading::default();
        }
    });
    assert_eq!(flown.changes.len(), 1, "{:?}", flown.changes);
    assert!(flown.roll_deg < 2.0, "{}", flown.roll_deg);
}

#[test]
fn one_that_is_wrong_beside_the_one_that_is_used_changes_nothing() {
    let flown = fly(2, |measured, unit, _| inverted(&[1], measured, unit));
    assert_eq!(flown.changes, []);
    assert!(flown.roll_deg < 2.0, "{}", flown.roll_deg);
}

/// Then the first is used, and doubted, as one alone.
#[test]
fn where_all_are_wrong_the_gyroscopes_are_doubted() {
    let flown = fly(2, |measured, unit, _| inverted(&[0, 1], measured, unit));
    assert!(flown.doubted_at_the_end);
    assert!(flown.changes.len() <= 2, "{:?}", flown.changes);
}
