//! Gyroscopes that are wrong in ways that their samples alone do not show, and
//! magnetometers that are.

use std::ops::Range;
use std::time::Duration;

use fcc_core::flight::atmosphere::pressure_pa;
use fcc_core::flight::orientation::earth_to_body;
use fcc_core::flight::{BodyRates, GnssFix, MagneticField, Measurements, SpecificForce};
use fcc_core::framework::{Reading, Time};
use fcc_navigation::inertial::{MagneticNorth, RawNavigation, RawNavigationConfig};

use super::flight::Flight;
use super::noise::Random;
use super::sensors::{FIELD_UT, time};

const TICK_S: f64 = 0.025;
const FAILS_S: f64 = 30.0;

/// What is made of rates, rad/s, and of the field, µT, and the time since it failed.
type Fault = fn(&mut [f64; 3], &mut [f64; 3], f64, &mut Random);

/// Turns to the left and to the right by 25° of bank, in between straight flight.
fn turns(time_s: f64) -> (f64, f64, f64) {
    let share = (time_s / 10.0 * std::f64::consts::PI).sin();
    (25.0_f64.to_radians() * share * share * share, 0.0, 50.0)
}

fn straight(time_s: f64) -> (f64, f64, f64) {
    if time_s < FAILS_S {
        turns(time_s)
    } else {
        (0.0, 0.0, 50.0)
    }
}

/// What the sensors of a small computer give of the truth, these rates, rad/s, and this
/// field, µT; now and then a receiver's fix, too.
pub(super) fn readings(
    truth: &super::flight::Truth,
    now: Time,
    rates: [f64; 3],
    field: [f64; 3],
    has_fix: bool,
) -> Measurements {
    let [x_ut, y_ut, z_ut] = field;
    let [x_mps2, y_mps2, z_mps2] = truth.force;
    let mut measured = Measurements {
        raw_body_rates: Reading::new(
            BodyRates {
                roll_radps: rates[0],
                pitch_radps: rates[1],
                yaw_radps: rates[2],
            },
            now,
        ),
        raw_specific_force: Reading::new(
            SpecificForce {
                x_mps2,
                y_mps2,
                z_mps2,
            },
            now,
        ),
        magnetic_field: Reading::new(MagneticField { x_ut, y_ut, z_ut }, now),
        static_pressure_pa: Reading::new(pressure_pa(truth.place.altitude_m), now),
        // At 500 m, 1.17 kg/m³.
        differential_pressure_pa: Reading::new(0.5 * 1.167 * 50.0 * 50.0, now),
        ..Measurements::default()
    };
    if has_fix {
        let mut fix = GnssFix::default();
        fix.position.latitude_rad = truth.place.latitude_rad;
        fix.position.longitude_rad = truth.place.longitude_rad;
        fix.position.altitude_m = truth.place.altitude_m;
        [
            fix.velocity.north_mps,
            fix.velocity.east_mps,
            fix.velocity.down_mps,
        ] = truth.velocity;
        measured.gnss = Reading::new(fix, now);
    }
    measured
}

/// Flies with a fault from 30 s until `until_s`; the times at which gyroscopes began
/// and ended to be doubted, after the fault began.
fn doubted(
    manoeuvre: super::flight::Manoeuvre,
    fault: Fault,
    until_s: f64,
    end_s: f64,
) -> Vec<f64> {
    let faulty_s = FAILS_S..until_s;
    changes(
        manoeuvre,
        fault,
        faulty_s,
        end_s,
        RawNavigation::doubts_gyroscopes,
    )
}

/// Flies with a fault for a time; when something changed, after the fault began.
fn changes(
    manoeuvre: super::flight::Manoeuvre,
    fault: Fault,
    faulty_s: Range<f64>,
    end_s: f64,
    what: fn(&RawNavigation) -> bool,
) -> Vec<f64> {
    let flight = Flight::new(manoeuvre, 0.5, [4.0, -3.0]);
    changes_of(flight, fault, faulty_s, end_s, what)
}

fn changes_of(
    mut flight: Flight,
    fault: Fault,
    faulty_s: Range<f64>,
    end_s: f64,
    what: fn(&RawNavigation) -> bool,
) -> Vec<f64> {
    let mut random = Random::new(7);
    let mut navigation = RawNavigation::new(RawNavigationConfig {
        delay: Duration::from_millis(150),
        north: MagneticNorth::Field(FIELD_UT),
    });
    let mut changes = Vec::new();
    let mut was = false;
    for tick in 0_u32.. {
        flight.step(TICK_S);
        let truth = flight.now;
        if truth.time_s > end_s {
            break;
        }
        let now = time(truth.time_s);
        let noise = random.vector(0.002);
        let mut rates = [0, 1, 2].map(|axis| truth.rates[axis] + 0.005 + noise[axis]);
        // That of a phone's magnetometer.
        let noise = random.vector(0.6);
        let field = earth_to_body(truth.quaternion, FIELD_UT);
        let mut field = [0, 1, 2].map(|axis| field[axis] + noise[axis]);
        let since_s = truth.time_s - faulty_s.start;
        if faulty_s.contains(&truth.time_s) {
            fault(&mut rates, &mut field, since_s, &mut random);
        }
        let measured = readings(&truth, now, rates, field, tick % 8 == 0);
        navigation.step(now, &measured);
        if what(&navigation) != was {
            was = !was;
            changes.push(since_s);
        }
    }
    changes
}

const WRONG: [(&str, Fault); 6] = [
    ("inverted roll", |rates, _, _, _| rates[0] = -rates[0]),
    ("stuck roll, with noise", |rates, _, _, random| {
        rates[0] = random.normal(0.003);
    }),
    ("all frozen, with noise", |rates, _, _, random| {
        *rates = random.vector(0.003);
    }),
    ("scale 0.3", |rates, _, _, _| {
        *rates = rates.map(|rate| 0.3 * rate);
    }),
    ("clipped at 2 °/s", |rates, _, _, _| {
        *rates = rates.map(|rate| rate.clamp(-0.035, 0.035));
    }),
    ("roll and yaw swapped", |rates, _, _, _| rates.swap(0, 2)),
];

#[test]
fn wrong_gyroscopes_are_doubted_within_one_roll_into_a_turn() {
    for (name, fault) in WRONG {
        let changes = doubted(turns, fault, 40.0, 40.0);
        // A turn lasts for 10 s, and rolls at up to 10 °/s.
        assert_eq!(changes.len(), 1, "{name}: {changes:?}");
        assert!((0.2..10.0).contains(&changes[0]), "{name}: {changes:?}");
    }
}

/// The field does not count before it has been where it is expected for 10 s: until
/// then a wrong gyroscope is not found, and the autopilot is not to engage.
#[test]
fn gyroscopes_that_cannot_be_checked_yet_are_waited_for() {
    fn later(time_s: f64) -> (f64, f64, f64) {
        turns((time_s - 20.0).max(0.0))
    }
    let awaits = |fault: Fault| changes(later, fault, 0.0..40.0, 40.0, RawNavigation::awaits_field);
    let sound: Fault = |_, _, _, _| {};
    let inverted: Fault = |rates, _, _, _| rates[0] = -rates[0];
    for fault in [sound, inverted] {
        let waits = awaits(fault);
        assert_eq!(waits.len(), 2, "{waits:?}");
        assert!(
            waits[0] < 1.5 && (10.0..13.0).contains(&waits[1]),
            "{waits:?}"
        );
    }
    // It turns from 20 s on.
    let found = changes(
        later,
        inverted,
        0.0..40.0,
        40.0,
        RawNavigation::doubts_gyroscopes,
    );
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((20.0..30.0).contains(&found[0]), "{found:?}");
    // A field that is not the earth's is not waited for any longer, nor one that is silent.
    let turning: Fault = |_, field, time_s, _| {
        let turned = 0.2 * time_s;
        *field = [40.0 * turned.cos(), 40.0 * turned.sin(), 0.0];
    };
    let waits = awaits(turning);
    assert_eq!(waits.len(), 2, "{waits:?}");
    assert!((20.0..22.0).contains(&waits[1]), "{waits:?}");
    let silent: Fault = |_, field, time_s, _| {
        if time_s > 4.0 {
            *field = [f64::NAN; 3];
        }
    };
    let waits = awaits(silent);
    assert!((5.0..5.2).contains(&waits[1]), "{waits:?}");
}

#[test]
fn they_are_believed_again_when_they_have_agreed_while_turning() {
    // Stuck ones agree in straight flight.
    let stuck: Fault = |rates, _, _, random| *rates = random.vector(0.003);
    let changes = doubted(turns, stuck, 45.0, 110.0);
    assert_eq!(changes.len(), 2, "{changes:?}");
    assert!(changes[1] > 20.0 && changes[1] < 60.0, "{changes:?}");
    let bank_only = |time_s: f64| {
        if time_s < 40.0 {
            turns(time_s)
        } else {
            straight(time_s)
        }
    };
    assert_eq!(doubted(bank_only, stuck, 45.0, 110.0).len(), 1);
}

/// What an aircraft does whose autopilot believes that it rolls to the right.
fn rolls_to_the_left(time_s: f64) -> (f64, f64, f64) {
    if time_s < FAILS_S {
        turns(time_s)
    } else {
        (-0.7 * (time_s - FAILS_S).min(1.5), 0.0, 50.0)
    }
}

/// 32767 steps of a gyroscope of ±250 °/s, which has 131 LSB/(°/s) (product
/// specification of the MPU-6000 and MPU-6050, revision 3.4, section 6.1).
const FULL_SCALE: f64 = 32767.0 / 131.0 * std::f64::consts::PI / 180.0;

const STUCK_AXES: [(&str, Fault); 5] = [
    ("roll at 1 rad/s", |rates, _, _, _| rates[0] = 1.000_027),
    ("roll at full scale", |rates, _, _, _| rates[0] = FULL_SCALE),
    ("pitch at full scale", |rates, _, _, _| {
        rates[1] = -FULL_SCALE;
    }),
    ("yaw at full scale", |rates, _, _, _| rates[2] = FULL_SCALE),
    ("all at full scale", |rates, _, _, _| {
        *rates = [FULL_SCALE; 3];
    }),
];

#[test]
fn an_axis_stuck_at_a_rate_is_doubted_at_once_and_while_it_lasts() {
    for (name, fault) in STUCK_AXES {
        let changes = doubted(straight, fault, 40.0, 40.0);
        // Eight repeats at 40 Hz.
        assert_eq!(changes.len(), 1, "{name}: {changes:?}");
        assert!((0.19..0.26).contains(&changes[0]), "{name}: {changes:?}");
    }
    // Then it turns without the fault.
    let changes = doubted(turns, STUCK_AXES[0].1, 45.0, 110.0);
    assert_eq!(changes.len(), 2, "{changes:?}");
    assert!(changes[1] > 15.0, "{changes:?}");
}

#[test]
fn a_rate_far_beyond_the_turn_of_the_aircraft_is_doubted() {
    let roll: Fault = |rates, _, _, random| rates[0] = FULL_SCALE + random.normal(0.003);
    let changes = doubted(rolls_to_the_left, roll, 34.0, 34.0);
    assert_eq!(changes.len(), 1, "{changes:?}");
    assert!(changes[0] < 2.0, "{changes:?}");
}

#[test]
fn a_coarse_gyroscope_is_believed_in_a_steady_turn() {
    let steady = |time_s: f64| (0.8 * (time_s / 20.0).min(1.0), 0.0, 50.0);
    // Of ±2000 °/s: 16.4 LSB/(°/s), by the same table.
    let coarse: Fault = |rates, _, _, _| {
        let step = (1.0 / 16.4_f64).to_radians();
        *rates = rates.map(|rate| (rate / step).round() * step);
    };
    assert!(doubted(steady, coarse, 60.0, 60.0).is_empty());
}

const MAGNETOMETER: [(&str, Fault); 12] = [
    ("none", |_, _, _, _| {}),
    ("frozen", |_, field, _, _| *field = [20.0, -10.0, 43.0]),
    ("frozen, with noise", |_, field, _, random| {
        let noise = random.vector(0.6);
        *field = [20.0 + noise[0], -10.0 + noise[1], 43.0 + noise[2]];
    }),
    ("turned by 30°", |_, field, _, _| {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let [x, y, _] = *field;
        (field[0], field[1]) = (cos * x - sin * y, sin * x + cos * y);
    }),
    ("off by 20 µT", |_, field, _, _| field[1] += 20.0),
    ("off by 200 µT", |_, field, _, _| field[0] += 200.0),
    ("noise x 10", |_, field, _, random| {
        let noise = random.vector(6.0);
        *field = [0, 1, 2].map(|axis| field[axis] + noise[axis]);
    }),
    (
        "the field of a current of 10 µT, on and off",
        |_, field, since_s, _| {
            field[1] += 5.0 + 5.0 * (since_s * 0.8).sin();
        },
    ),
    ("jumps by 30° each 3 s", |_, field, since_s, _| {
        if since_s % 6.0 < 3.0 {
            let (sin, cos) = 30.0_f64.to_radians().sin_cos();
            let [_, y, z] = *field;
            (field[1], field[2]) = (cos * y - sin * z, sin * y + cos * z);
        }
    }),
    ("turns to the right by 4°/s", |_, field, since_s, _| {
        turn_about_down(field, 4.0 * since_s);
    }),
    ("turns to the left by 4°/s", |_, field, since_s, _| {
        turn_about_down(field, -4.0 * since_s);
    }),
    (
        "the field of a current that follows the ailerons",
        |rates, field, _, _| {
            // Half of the ailerons, for 10 °/s of roll, are 12 µT.
            field[1] += 70.0 * rates[0];
            field[2] += 21.0 * rates[0];
        },
    ),
];

/// In its mount.
fn turn_about_down(field: &mut [f64; 3], angle_deg: f64) {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let [x, y, _] = *field;
    (field[0], field[1]) = (cos * x + sin * y, cos * y - sin * x);
}

#[test]
fn a_wrong_magnetometer_does_not_make_gyroscopes_doubted() {
    for (name, fault) in MAGNETOMETER {
        for manoeuvre in [turns as super::flight::Manoeuvre, straight] {
            let changes = doubted(manoeuvre, fault, 70.0, 70.0);
            assert!(changes.is_empty(), "{name}: {changes:?}");
        }
    }
}

/// Whatever the direction of the turn against the field's. A turn about a direction that is
/// close to the field moves it little, and one that is turned by 30° as much as it is turned.
#[test]
fn a_compass_that_is_turned_does_not_make_gyroscopes_doubted_on_any_heading() {
    fn steep(time_s: f64) -> (f64, f64, f64) {
        let (bank, climb, airspeed) = turns(time_s);
        (1.6 * bank, climb, airspeed)
    }
    let turned: Fault = |_, field, _, _| {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let [x, y, _] = *field;
        (field[0], field[1]) = (cos * x - sin * y, sin * x + cos * y);
    };
    for sixth in 0_u32..6 {
        let heading_rad = f64::from(sixth) * std::f64::consts::FRAC_PI_3;
        let flight = Flight::new(steep, heading_rad, [4.0, -3.0]).in_turbulence(sixth.into());
        let doubted = RawNavigation::doubts_gyroscopes;
        let changes = changes_of(flight, turned, FAILS_S..90.0, 90.0, doubted);
        assert!(changes.is_empty(), "{heading_rad}: {changes:?}");
    }
}
