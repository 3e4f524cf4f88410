//! Quantities sensors, and good ones that may look frozen.

use std::vec::Vec;

use super::*;
use fcc_core::flight::{Attitude, BodyRates, SpecificForce, Velocity};
use fcc_core::framework::Reading;

const DT_S: f64 = 0.025;
const AFTER_S: f64 = 2.0;
const FINE: Resolutions = Resolutions {
    heading_rad: 1e-9,
    airspeed_mps: 1e-9,
    altitude_step_m: 0.0,
};

/// An aircraft that rolls by 10 °/s for 3 s, then turns by 5 °/s and
/// climbs by 5 m/s; every value a little different from tick to tick.
fn flying(tick: i64) -> Measurements {
    let at = Time::from_nanos(tick * 25_000_000);
    let t_s = tick as f64 * DT_S;
    let tiny = (tick % 7) as f64 * 1e-9;
    let rolling = t_s < 3.0;
    let roll_deg = 10.0 * t_s.min(3.0);
    let since_s = (t_s - 3.0).max(0.0);
    let heading_rad = (5.0 * since_s).to_radians();
    let yaw = if rolling { 0.0 } else { 5.0_f64.to_radians() };
    let roll_rad = roll_deg.to_radians();
    let rates = BodyRates {
        roll_radps: if rolling { 10.0_f64.to_radians() } else { 0.0 } + tiny,
        pitch_radps: yaw * sin(roll_rad),
        yaw_radps: yaw * cos(roll_rad),
    };
    let climb_mps = if rolling { 0.0 } else { 5.0 };
    let force = SpecificForce {
        z_mps2: -9.81 / cos(roll_rad) + tiny,
        ..SpecificForce::default()
    };
    let attitude = Attitude {
        roll_rad: roll_rad + tiny,
        pitch_rad: 0.05 + tiny,
    };
    Measurements {
        attitude: Reading::new(attitude, at),
        heading_rad: Reading::new(heading_rad + tiny, at),
        body_rates: Reading::new(rates, at),
        specific_force: Reading::new(force, at),
        airspeed_mps: Reading::new(51.0 + tiny, at),
        altitude_m: Reading::new(914.0 + 5.0 * since_s + tiny, at),
        velocity: Reading::new(
            Velocity {
                down_mps: -climb_mps,
                ..Velocity::default()
            },
            at,
        ),
        ..Measurements::default()
    }
}

/// The times, in s, at which each quantity is reported as frozen over 20 s.
fn watch(mut measured: impl FnMut(i64) -> Measurements) -> Vec<(f64, Quantities)> {
    let mut watch = FrozenDetector::new(AFTER_S);
    let known = Known {
        felt_mps2: 0.0,
        felt_up_mps2: 0.0,
        resolutions: FINE,
        rate_bias_radps: [0.0; 3],
    };
    let mut seen = Vec::new();
    for tick in 0..800 {
        let measurements = measured(tick);
        watch.step(&measurements, &known, DT_S);
        let frozen = watch.frozen();
        if seen.last().is_none_or(|(_, last)| *last != frozen) {
            seen.push((tick as f64 * DT_S, frozen));
        }
    }
    seen
}

/// The flight with one quantity frozen at its first value, with new times.
fn with_frozen(freeze: fn(&mut Measurements, &Measurements)) -> Vec<(f64, Quantities)> {
    let start = flying(0);
    watch(|tick| {
        let mut measurements = flying(tick);
        freeze(&mut measurements, &start);
        measurements
    })
}

#[test]
fn changing_values_are_not_frozen() {
    assert_eq!(watch(flying), [(0.0, Quantities::NONE)]);
}

/// The others live: it shows 10 °/s where the aircraft does not roll.
#[test]
fn a_single_gyroscope_is_detected() {
    let seen = with_frozen(|m, start| {
        m.body_rates.value.roll_radps = start.body_rates.value.roll_radps;
    });
    let expected = Quantity::BodyRates.alone();
    assert!(
        matches!(seen[..], [_, (3.0..4.0, frozen)] if frozen == expected),
        "{seen:?}"
    );
}

#[test]
fn each_is_detected_when_the_aircraft_moves_and_no_other() {
    type Case = (fn(&mut Measurements, &Measurements), Quantities, f64);
    let cases: [Case; 5] = [
        // A roll of 5° takes half a second; the least time is 2 s.
        (
            |m, start| m.attitude.value = start.attitude.value,
            Quantity::Attitude.alone(),
            2.0,
        ),
        // 5 °/s from 3 s on: 5° at 4 s, minus a small leak.
        (
            |m, start| m.heading_rad.value = start.heading_rad.value,
            Quantity::Heading.alone(),
            4.05,
        ),
        // They still show 10 °/s from 3 s on, where it does not roll.
        (
            |m, start| m.body_rates.value = start.body_rates.value,
            Quantity::BodyRates.alone(),
            3.5,
        ),
        // 10° of bank are reached after a second.
        (
            |m, start| m.specific_force.value = start.specific_force.value,
            Quantity::SpecificForce.alone(),
            2.0,
        ),
        (
            |m, start| m.airspeed_mps.value = start.airspeed_mps.value,
            Quantity::Airspeed.alone(),
            2.0,
        ),
    ];
    for (freeze, expected, at_s) in cases {
        let seen = with_frozen(freeze);
        let [_, (seen_s, frozen)] = seen[..] else {
            panic!("{seen:?} is not {expected:?}");
        };
        assert_eq!(frozen, expected);
        assert!((seen_s - at_s).abs() < 0.1, "{frozen:?} at {seen_s} s");
    }
}

#[test]
fn in_calm_air_unchanged_values_are_not_frozen() {
    let calm = flying(0);
    let seen = watch(|tick| {
        let at = Time::from_nanos(tick * 25_000_000);
        let mut measurements = calm;
        measurements.body_rates.value.roll_radps = 0.4_f64.to_radians();
        measurements.attitude.taken = at;
        measurements.heading_rad.taken = at;
        measurements.body_rates.taken = at;
        measurements.airspeed_mps.taken = at;
        measurements.altitude_m.taken = at;
        measurements.specific_force.taken = at;
        measurements
    });
    assert_eq!(seen, [(0.0, Quantities::NONE)]);
}

#[test]
fn a_value_that_changes_again_is_no_longer_frozen() {
    let start = flying(0);
    let seen = watch(|tick| {
        let mut measurements = flying(tick);
        if tick < 400 {
            measurements.airspeed_mps.value = start.airspeed_mps.value;
        }
        measurements
    });
    assert_eq!(seen.len(), 3, "{seen:?}");
    assert_eq!(seen[2], (10.0, Quantities::NONE));
}

/// The flight by coarse sensors, good until `frozen_at_s`; when each quantity is
/// reported as frozen. `felt_mps2` is what the accelerometers feel.
fn watch_coarse(frozen_at_s: f64, felt_mps2: f64) -> Vec<(f64, Quantities)> {
    const STEP_M: f64 = 30.48;
    const STEP_MPS: f64 = 0.514_444;
    const STEP_RAD: f64 = 0.017_453;
    let round = |value: f64, step: f64| libm::round(value / step) * step;
    let mut watch = FrozenDetector::new(AFTER_S);
    let known = Known {
        felt_mps2,
        felt_up_mps2: 0.0,
        resolutions: Resolutions {
            heading_rad: STEP_RAD,
            airspeed_mps: STEP_MPS,
            altitude_step_m: STEP_M,
        },
        rate_bias_radps: [0.0; 3],
    };
    let last = flying((frozen_at_s / DT_S) as i64);
    let mut seen = Vec::new();
    for tick in 0..2_000 {
        let t_s = tick as f64 * DT_S;
        let is = flying(tick);
        let shown = if t_s < frozen_at_s { &is } else { &last };
        let mut measurements = is;
        let gained_mps = felt_mps2 * t_s.min(frozen_at_s);
        measurements.airspeed_mps.value = round(shown.airspeed_mps.value + gained_mps, STEP_MPS);
        measurements.altitude_m.value = round(shown.altitude_m.value, STEP_M);
        measurements.heading_rad.value = round(shown.heading_rad.value, STEP_RAD);
        watch.step(&measurements, &known, DT_S);
        if seen.last().is_none_or(|(_, last)| *last != watch.frozen()) {
            seen.push((t_s, watch.frozen()));
        }
    }
    seen
}

/// A roll, a turn and a climb by 5 m/s, in which the airspeed never changes.
#[test]
fn good_coarse_sensors_are_not_frozen() {
    assert_eq!(watch_coarse(60.0, 0.0), [(0.0, Quantities::NONE)]);
    assert_eq!(watch_coarse(60.0, 0.3), [(0.0, Quantities::NONE)]);
}

/// 6° at 5 °/s take 1.2 s,
/// so the least time of 2 s counts. 1 m/s² must gain 8.0 m/s: 8 s without it, and 14.7 s with it.
#[test]
fn frozen_coarse_sensors_are_found() {
    let seen = watch_coarse(20.0, 1.0);
    let at_s = |quantity: Quantity| {
        let (at_s, _) = seen
            .iter()
            .find(|(_, frozen)| frozen.contains(quantity))
            .unwrap();
        at_s - 20.0
    };
    assert!((1.0..2.1).contains(&at_s(Quantity::Heading)));
    assert!((8.0..15.0).contains(&at_s(Quantity::Airspeed)));
}
