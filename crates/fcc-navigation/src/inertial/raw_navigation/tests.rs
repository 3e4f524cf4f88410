use libm::hypot;

use super::super::{GeodeticPosition, earth_field_ut};
use core::time::Duration;

use super::*;
use fcc_core::flight::{BodyRates, GnssFix, MagneticField, PlantState, Position, SpecificForce};

/// At rest, the nose to magnetic east.
fn raw(now: Time, [north_ut, down_ut]: [f64; 2]) -> Measurements {
    let force = SpecificForce {
        z_mps2: -9.81,
        ..SpecificForce::default()
    };
    let field = MagneticField {
        y_ut: -north_ut,
        z_ut: down_ut,
        ..MagneticField::default()
    };
    Measurements {
        raw_body_rates: Reading::new(BodyRates::default(), now),
        raw_specific_force: Reading::new(force, now),
        magnetic_field: Reading::new(field, now),
        static_pressure_pa: Reading::new(89_874.6, now),
        ..Measurements::default()
    }
}

fn config() -> RawNavigationConfig {
    RawNavigationConfig {
        delay: Duration::from_millis(200),
        north: MagneticNorth::ModelOf(2027.5),
    }
}

fn tick(n: i64) -> Time {
    Time::from_nanos(n * 25_000_000)
}

/// In Alaska, where magnetic north is 14° to the east.
#[test]
fn the_magnetic_heading_stays_when_the_declination_becomes_known() {
    let place = GeodeticPosition {
        latitude_rad: 60.0_f64.to_radians(),
        longitude_rad: -150.0_f64.to_radians(),
        altitude_m: 1_000.0,
    };
    let [north_ut, east_ut, down_ut] = earth_field_ut(place, 2027.5).unwrap();
    assert!((10.0..18.0).contains(&atan2(east_ut, north_ut).to_degrees()));
    let field = [hypot(north_ut, east_ut), down_ut];
    let fix = GnssFix {
        position: Position {
            latitude_rad: place.latitude_rad,
            longitude_rad: place.longitude_rad,
            altitude_m: place.altitude_m,
        },
        ..GnssFix::default()
    };
    let mut navigation = RawNavigation::new(config());
    for n in 0..1_600 {
        let mut measured = raw(tick(n), field);
        if n >= 400 && n % 8 == 0 {
            measured.gnss = Reading::new(fix, tick(n));
        }
        let found = navigation.step(tick(n), &measured);
        if n > 100 {
            let heading_deg = found.heading_rad.value.to_degrees();
            assert!((heading_deg - 90.0).abs() < 1.0, "{n}: {heading_deg}");
        }
    }
    // ISO 2533: 89,874.6 Pa are 1,000 m.
    assert!((navigation.found().altitude_m.value - 1_000.0).abs() < 0.1);
    assert_eq!(navigation.found().position.value, fix.position);
}

#[test]
fn without_a_gyroscope_for_long_the_attitude_becomes_old() {
    let mut navigation = RawNavigation::new(config());
    for n in 0..400 {
        let mut measured = raw(tick(n), [20.0, 40.0]);
        if n >= 200 {
            measured.raw_body_rates = Reading::new(BodyRates::default(), tick(199));
        }
        navigation.step(tick(n), &measured);
    }
    assert_eq!(navigation.found().attitude.taken, tick(199));
    assert_eq!(navigation.found().body_rates.taken, tick(199));
    assert_eq!(navigation.found().altitude_m.taken, tick(399));
}

#[test]
fn impossible_and_future_readings_are_not_used() {
    let mut navigation = RawNavigation::new(config());
    for n in 0..200 {
        let mut measured = raw(tick(n), [20.0, 40.0]);
        measured.differential_pressure_pa = Reading::new(f64::INFINITY, tick(n));
        measured.static_pressure_pa = Reading::new(50_000.0, tick(n + 10));
        navigation.step(tick(n), &measured);
    }
    let found = navigation.found();
    assert!(found.airspeed_mps.is_never() && found.altitude_m.is_never());
    assert!(found.attitude.value.roll_rad.abs() < 0.02);
}

/// A register that is read wrong: finite, and nothing that a sensor can measure. A
/// single one, integrated, would cost the attitude for minutes.
#[test]
fn finite_readings_that_nothing_can_measure_are_not_used() {
    for [force, rate, field] in [
        [3.4e38, 0.0, 0.0],
        [0.0, -3.4e38, 0.0],
        [0.0, 0.0, 3.4e38],
        // 300 g; ten turns each in a tenth of a second; 30 mT.
        [-2_942.0, 628.0, 30_000.0],
    ] {
        let mut navigation = RawNavigation::new(config());
        for n in 0..400 {
            let mut measured = raw(tick(n), [20.0, 40.0]);
            if n == 200 {
                measured.raw_specific_force.value.x_mps2 += force;
                measured.raw_body_rates.value.roll_radps += rate;
                measured.magnetic_field.value.x_ut += field;
            }
            let found = navigation.step(tick(n), &measured);
            if n > 100 {
                let attitude = found.attitude.value;
                assert!(attitude.roll_rad.abs() < 0.02 && attitude.pitch_rad.abs() < 0.02);
                let off_rad = found.heading_rad.value - core::f64::consts::FRAC_PI_2;
                assert!(off_rad.abs() < 0.02, "{n}: {off_rad}");
            }
        }
    }
}

/// A driver that repeats its last sample, while the aircraft begins to bank.
#[test]
fn a_gyroscope_that_repeats_itself_in_motion_is_left_out() {
    let mut navigation = RawNavigation::new(config());
    for n in 0..400 {
        let mut measured = raw(tick(n), [20.0, 40.0]);
        let still = BodyRates {
            roll_radps: 1e-4 * (n.min(200) as f64),
            ..BodyRates::default()
        };
        measured.raw_body_rates = Reading::new(still, tick(n));
        if n > 200 {
            measured.raw_specific_force.value.y_mps2 = -3.0;
        }
        navigation.step(tick(n), &measured);
    }
    // Half a second, 20 ticks, after its last change.
    assert_eq!(navigation.found().attitude.taken, tick(219));
    // At rest it may.
    let mut navigation = RawNavigation::new(config());
    for n in 0..400 {
        navigation.step(tick(n), &raw(tick(n), [20.0, 40.0]));
    }
    assert_eq!(navigation.found().attitude.taken, tick(399));
}

#[test]
fn a_place_that_is_repeated_by_a_receiver_that_moves_is_left_out() {
    let mut navigation = RawNavigation::new(config());
    for n in 0..80 {
        let mut fix = GnssFix::default();
        fix.velocity.north_mps = 50.0;
        fix.position.latitude_rad = 0.5 + 1e-5 * (n.min(40) as f64);
        let mut measured = raw(tick(n), [20.0, 40.0]);
        measured.gnss = Reading::new(fix, tick(n));
        navigation.step(tick(n), &measured);
        assert!(!navigation.repeats_place());
    }
    assert_eq!(navigation.found().velocity.taken, tick(40));
}

/// A receiver of one fix a second, which is read five times a second, is healthy; one
/// that gives the same place for more than two seconds at 50 m/s is not.
#[test]
fn a_receiver_that_repeats_its_place_for_seconds_is_named() {
    let mut navigation = RawNavigation::new(config());
    for n in 0..800 {
        let place = if n < 400 { n / 40 } else { 10 };
        let mut fix = GnssFix::default();
        fix.velocity.north_mps = 50.0;
        fix.position.latitude_rad = 0.5 + 8e-6 * place as f64;
        let mut measured = raw(tick(n), [20.0, 40.0]);
        measured.gnss = Reading::new(fix, tick(n / 8 * 8));
        navigation.step(tick(n), &measured);
        // The last new place was that of tick 400.
        assert_eq!(navigation.repeats_place(), n >= 488, "{n}");
    }
}

/// Five fixes a second of an aircraft at 50 m/s. One of a coarse resolution may have the same
/// velocity for two seconds.
#[test]
fn a_receiver_that_repeats_its_velocity_for_seconds_is_named() {
    let mut navigation = RawNavigation::new(config());
    let mut told = std::vec::Vec::new();
    for n in 0..800 {
        let at = n / 8;
        let mut fix = GnssFix::default();
        let velocities = if n < 320 { at / 10 } else { 40 };
        fix.velocity.north_mps = 50.0 + 0.05 * velocities as f64;
        fix.position.latitude_rad = 0.5 + 1.6e-6 * at as f64;
        let mut measured = raw(tick(n), [20.0, 40.0]);
        // The first fix comes after two seconds.
        if n >= 80 {
            measured.gnss = Reading::new(fix, tick(at * 8));
        }
        navigation.step(tick(n), &measured);
        if let Some(is_refused) = navigation.refuses_velocity() {
            told.push((n, is_refused));
        }
    }
    // The last new velocity was that of tick 320.
    assert_eq!(told, [(408, true)]);
}

/// A driver that repeats its last sample while the aircraft begins to turn, and then
/// measures again.
#[test]
fn a_magnetometer_that_repeats_its_field_in_motion_is_left_out_and_named() {
    let mut navigation = RawNavigation::new(config());
    for n in 0..600 {
        let mut measured = raw(tick(n), [20.0, 40.0]);
        if n > 200 {
            measured.raw_body_rates.value.yaw_radps = 0.1;
        }
        if n > 400 {
            measured.magnetic_field.value.x_ut = 1e-3 * n as f64;
        }
        navigation.step(tick(n), &measured);
        // Half a second after it has begun to turn; at rest it may.
        assert_eq!(navigation.repeats_field(), (201..=400).contains(&n), "{n}");
    }
}

/// From Alaska, where magnetic north is 14° to the east, to where it is 5° to the
/// west or less: the field is the model's there.
#[test]
fn after_a_jump_the_field_is_that_of_the_new_place() {
    let mut navigation = RawNavigation::new(config());
    for (part, (latitude_deg, longitude_deg)) in [(0, (60.0, -150.0)), (1, (45.0, -88.0))] {
        let place = GeodeticPosition {
            latitude_rad: f64::to_radians(latitude_deg),
            longitude_rad: f64::to_radians(longitude_deg),
            altitude_m: 1_000.0,
        };
        let [north_ut, east_ut, down_ut] = earth_field_ut(place, 2027.5).unwrap();
        let mut fix = GnssFix::default();
        fix.position.latitude_rad = place.latitude_rad;
        fix.position.longitude_rad = place.longitude_rad;
        fix.position.altitude_m = place.altitude_m;
        for n in 0..800 {
            let now = tick(800 * part + n);
            let mut measured = raw(now, [hypot(north_ut, east_ut), down_ut]);
            let state = if part == 1 && n == 0 {
                PlantState::Jumped
            } else {
                PlantState::Running
            };
            let plant = fcc_core::flight::Plant {
                state,
                ..fcc_core::flight::Plant::default()
            };
            measured.plant = Reading::new(plant, now);
            measured.gnss = Reading::new(fix, now);
            navigation.step(now, &measured);
        }
        let heading_deg = navigation.found().heading_rad.value.to_degrees();
        assert!((heading_deg - 90.0).abs() < 1.0, "{part}: {heading_deg}");
        assert_eq!(navigation.declination_rad, atan2(east_ut, north_ut));
    }
}

/// The plant was put somewhere else: what was known is not true there.
#[test]
fn after_a_jump_it_begins_anew() {
    let mut navigation = RawNavigation::new(config());
    let mut jumped = raw(tick(200), [20.0, 40.0]);
    jumped.plant = Reading::new(
        fcc_core::flight::Plant {
            state: PlantState::Jumped,
            ..fcc_core::flight::Plant::default()
        },
        tick(200),
    );
    for n in 0..200 {
        navigation.step(tick(n), &raw(tick(n), [20.0, 40.0]));
    }
    assert!(!navigation.found().attitude.is_never());
    assert!(navigation.step(tick(200), &jumped).attitude.is_never());
}

/// What no aircraft does: faster than 450 m/s, above 20 km, off the earth.
#[test]
fn an_impossible_fix_is_not_used() {
    let possible = GnssFix {
        position: Position {
            latitude_rad: 0.7,
            longitude_rad: 0.1,
            altitude_m: 900.0,
        },
        ..GnssFix::default()
    };
    let changes: [fn(&mut GnssFix); 6] = [
        |fix| fix.velocity.north_mps = 500.0,
        |fix| fix.velocity.east_mps = 1e300,
        |fix| fix.velocity.down_mps = -451.0,
        |fix| fix.position.altitude_m = 1e6,
        |fix| fix.position.altitude_m = -501.0,
        |fix| fix.position.latitude_rad = 2.0,
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let mut navigation = RawNavigation::new(config());
        for n in 0..800 {
            let mut fix = possible;
            if n > 400 {
                change(&mut fix);
            }
            let mut measured = raw(tick(n), [20.0, 40.0]);
            if n % 8 == 0 {
                measured.gnss = Reading::new(fix, tick(n));
            }
            navigation.step(tick(n), &measured);
        }
        let found = navigation.found();
        assert_eq!(found.position.value, possible.position, "change {number}");
        assert_eq!(found.velocity.value, possible.velocity, "change {number}");
        // At rest and level, as before.
        let attitude = found.attitude.value;
        assert_eq!(found.attitude.taken, tick(799), "change {number}");
        assert!(attitude.roll_rad.hypot(attitude.pitch_rad) < 0.01);
    }
}
