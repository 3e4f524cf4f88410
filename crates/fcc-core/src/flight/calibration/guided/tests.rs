extern crate std;

use std::string::ToString as _;

use core::f64::consts::{FRAC_1_SQRT_2, PI};

use super::*;
use crate::flight::calibration::{AxesCalibration, levelled};
use crate::flight::orientation::{
    EulerAngles, body_to_earth, earth_to_body, quaternion_from_euler,
};
use crate::flight::{BodyRates, GnssFix, MagneticField, Position, SpecificForce, Velocity};
use crate::framework::Reading;

const G: f64 = 9.806_65;
const STEP_NS: i64 = 25_000_000;

/// Sensors in a hand, 40 times per s, with noise of 0.03 m/s², 0.002 rad/s,
/// 0.5 µT and 2 Pa.
struct Hand {
    calibration: GuidedCalibration,
    now: Time,
    noise: u64,
    /// What the sensors make of what is true.
    force: fn([f64; 3]) -> [f64; 3],
    field: fn([f64; 3]) -> [f64; 3],
    bias_radps: [f64; 3],
    /// North, east, down, µT.
    earth_ut: [f64; 3],
    pressure_pa: f64,
    temperature_k: f64,
    attitude: [f64; 4],
    fix: Option<GnssFix>,
}

impl Hand {
    fn new(kind: &GuidedKind) -> Self {
        Self {
            calibration: GuidedCalibration::new(kind),
            now: Time::from_nanos(0),
            noise: 1,
            force: |given| given,
            field: |given| given,
            bias_radps: [0.02, -0.01, 0.005],
            earth_ut: [21.0, 0.0, 45.0],
            pressure_pa: 0.0,
            temperature_k: 290.0,
            attitude: [1.0, 0.0, 0.0, 0.0],
            fix: None,
        }
    }

    /// Of a standard deviation of 1: twelve uniform numbers.
    fn draw(&mut self) -> f64 {
        let mut uniform = || {
            self.noise = self
                .noise
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (self.noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        (0..12).map(|_| uniform()).sum()
    }

    fn with_noise(&mut self, values: [f64; 3], sigma: f64) -> [f64; 3] {
        values.map(|value| value + sigma * self.draw())
    }

    /// One tick with this attitude, body to earth, from the last one.
    fn tick(&mut self, attitude: [f64; 4]) {
        self.now = Time::from_nanos(self.now.as_nanos() + STEP_NS);
        let dt_s = STEP_NS as f64 * 1e-9;
        // By how much each earth axis turned, as seen from the body.
        let turned = |axis: [f64; 3]| {
            let [one, other] = [self.attitude, attitude].map(|at| earth_to_body(at, axis));
            let [ax, ay, az] = one;
            let [bx, by, bz] = other;
            [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
        };
        let turns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(turned);
        let rate = |axis: usize| -0.5 * turns.iter().map(|turn| turn[axis]).sum::<f64>() / dt_s;
        let rates = [0, 1, 2].map(|axis| rate(axis) + self.bias_radps[axis]);
        self.attitude = attitude;
        let force = (self.force)(earth_to_body(attitude, [0.0, 0.0, -G]));
        let field = (self.field)(earth_to_body(attitude, self.earth_ut));
        let [x_mps2, y_mps2, z_mps2] = self.with_noise(force, 0.03);
        let [roll_radps, pitch_radps, yaw_radps] = self.with_noise(rates, 0.002);
        let [x_ut, y_ut, z_ut] = self.with_noise(field, 0.5).map(|part| part.min(800.0));
        let [pressure_pa, ..] = self.with_noise([self.pressure_pa; 3], 2.0);
        let force = SpecificForce {
            x_mps2,
            y_mps2,
            z_mps2,
        };
        let rates = BodyRates {
            roll_radps,
            pitch_radps,
            yaw_radps,
        };
        self.calibration.take(&Measurements {
            raw_specific_force: Reading::new(force, self.now),
            raw_body_rates: Reading::new(rates, self.now),
            magnetic_field: Reading::new(MagneticField { x_ut, y_ut, z_ut }, self.now),
            differential_pressure_pa: Reading::new(pressure_pa, self.now),
            air_temperature_k: Reading::new(self.temperature_k, self.now),
            gnss: self
                .fix
                .map_or_else(Reading::default, |fix| Reading::new(fix, self.now)),
            ..Measurements::default()
        });
    }

    fn hold(&mut self, attitude: [f64; 4], seconds: f64) {
        for _ in 0..(seconds * 40.0) as u32 {
            self.tick(attitude);
        }
    }

    /// So that this direction of its axes is up.
    fn place(&mut self, up: [f64; 3], seconds: f64) {
        let attitude = with_up(up);
        self.hold(attitude, seconds);
    }

    /// Through all directions, for so many seconds.
    fn tumble(&mut self, seconds: f64) {
        for n in 0..(seconds * 40.0) as u32 {
            let time_s = f64::from(n) / 40.0;
            self.tick(tumbling(time_s));
        }
    }

    fn finish(&self) -> Result<Found, Refusal> {
        self.calibration.finish()
    }
}

fn of(roll_rad: f64, pitch_rad: f64, heading_rad: f64) -> [f64; 4] {
    quaternion_from_euler(EulerAngles {
        roll_rad,
        pitch_rad,
        heading_rad,
    })
}

/// An attitude in which a direction of the body is up.
fn with_up([x, y, z]: [f64; 3]) -> [f64; 4] {
    // Up in body axes is (sin pitch, -cos pitch · sin roll, -cos pitch · cos roll).
    of((-y).atan2(-z), x.clamp(-1.0, 1.0).asin(), 0.3)
}

fn tumbling(time_s: f64) -> [f64; 4] {
    of(0.9 * time_s, 1.4 * (0.23 * time_s).sin(), 0.11 * time_s)
}

fn near(found: [f64; 3], expected: [f64; 3], within: f64) {
    for (one, other) in found.into_iter().zip(expected) {
        assert!((one - other).abs() < within, "{found:?}, not {expected:?}");
    }
}

/// A bias of 80 mg, a scale of 2 % and a misalignment of 1 %: the BMA250's
/// tolerances (Bosch BST-BMA250-DS002-05).
fn bma250([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        1.02 * x + 0.01 * y + 0.785,
        0.98 * y - 0.01 * z - 0.5,
        z + 0.3,
    ]
}

#[test]
fn an_accelerometer_is_calibrated_by_what_it_asks_for() {
    let mut hand = Hand::new(&GuidedKind::Accelerometer);
    hand.force = bma250;
    hand.place([0.0, 0.0, -1.0], 1.0);
    let mut asked = 0;
    while let Next::Place(place) | Next::Hold(place) = hand.calibration.next() {
        hand.tumble(1.0);
        hand.place(place.direction(), 3.5);
        asked += 1;
        assert!(asked <= 13, "{place}");
    }
    assert!(hand.calibration.is_complete() && hand.calibration.progress() == 1.0);
    let found = hand.finish().unwrap();
    let Values::Accelerometer(axes) = found.values else {
        panic!("{found:?}");
    };
    // 120 samples of 0.03 m/s² in each position.
    let calibration = AxesCalibration::new(&axes);
    for place in Place::ALL {
        let true_mps2 = place.direction().map(|part| G * part);
        let [x, y, z] = calibration.applied(bma250(true_mps2));
        assert!((norm([x, y, z]) - G).abs() < 0.02, "{place}");
    }
    near(axes.bias, [0.785, -0.5, 0.3], 0.01);
    assert!(
        found.quality.error < 0.02 && found.sigma < 0.01,
        "{found:?}"
    );
}

#[test]
fn too_few_positions_are_refused_with_their_number() {
    let mut hand = Hand::new(&GuidedKind::Accelerometer);
    for place in &Place::ALL[..4] {
        hand.place(place.direction(), 3.5);
    }
    let refused = Refusal::TooFew {
        have: 4,
        needed: 12,
    };
    assert_eq!(hand.finish(), Err(refused));
    assert!((hand.calibration.progress() - 4.0 / 12.0).abs() < 1e-12);
    assert_eq!(hand.calibration.next(), Next::Place(Place::ALL[4]));
    // The last is still held: it is not counted again.
    hand.place(Place::ALL[3].direction(), 5.0);
    assert_eq!(hand.finish(), Err(refused));
}

/// A hand that turns it by 20° per s is no rest, and neither is one that sinks
/// by 1° per s.
#[test]
fn what_moves_is_no_position() {
    for (rate, moves) in [(20.0_f64, false), (1.0, true)] {
        let mut hand = Hand::new(&GuidedKind::Accelerometer);
        for n in 0..240 {
            let turned = (rate * f64::from(n) / 40.0 - 3.0).to_radians();
            hand.tick(of(0.0, turned, 0.0));
        }
        assert!(hand.calibration.progress() < 1.0 / 12.0, "{rate}");
        let refused = hand.finish().unwrap_err();
        assert_eq!(matches!(refused, Refusal::Moved { .. }), moves, "{refused}");
    }
}

#[test]
fn a_gyroscopes_bias_is_found_at_rest() {
    let mut hand = Hand::new(&GuidedKind::Gyroscope);
    hand.hold(of(0.1, -0.2, 1.0), 5.0);
    assert_eq!(hand.calibration.next(), Next::LeaveAlone);
    hand.tumble(2.0);
    hand.hold(of(0.1, -0.2, 1.0), 11.5);
    let found = hand.finish().unwrap();
    let Values::Gyroscope { bias_radps } = found.values else {
        panic!("{found:?}");
    };
    // 400 samples of 0.002 rad/s: 0.0001 rad/s, within 4 standard deviations.
    near(bias_radps, [0.02, -0.01, 0.005], 4e-4);
    assert!((0.5e-4..3e-4).contains(&found.sigma), "{found:?}");
    assert_eq!(hand.calibration.temperature_k(), Some(290.0));
}

#[test]
fn a_gyroscope_that_is_moved_or_turns_is_refused() {
    let mut hand = Hand::new(&GuidedKind::Gyroscope);
    for _ in 0..3 {
        hand.hold(of(0.0, 0.0, 0.0), 4.0);
        hand.tumble(1.0);
    }
    assert_eq!(hand.finish(), Err(Refusal::Moved { times: 3 }));
    // 0.5°/s: too slow to be seen by its changes.
    for (axis, name) in [(0, "gravity"), (2, "the field")] {
        let mut hand = Hand::new(&GuidedKind::Gyroscope);
        for n in 0..480 {
            let mut angles = [0.0; 3];
            angles[axis] = (0.5 * f64::from(n) / 40.0_f64).to_radians();
            hand.tick(of(angles[0], angles[1], angles[2]));
        }
        let refused = hand.finish().unwrap_err();
        assert!(
            matches!(refused, Refusal::Turned { .. }),
            "{name}: {refused}"
        );
    }
    // A turntable, without a compass: 33 1/3 revolutions per minute.
    let mut hand = Hand::new(&GuidedKind::Gyroscope);
    hand.earth_ut = [0.0; 3];
    hand.bias_radps = [0.0, 0.0, 100.0 / 3.0 / 60.0 * 2.0 * PI];
    hand.hold(of(0.0, 0.0, 0.0), 12.0);
    let refused = hand.finish().unwrap_err();
    assert!(
        matches!(refused, Refusal::TooLarge { axis: 2, .. }),
        "{refused}"
    );
}

#[test]
fn sensors_that_warm_up_are_refused() {
    let mut hand = Hand::new(&GuidedKind::Gyroscope);
    for n in 0..480 {
        hand.temperature_k = 290.0 + 6.0 * f64::from(n) / 480.0;
        hand.tick(of(0.0, 0.0, 0.0));
    }
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::Warmed { by_k } if by_k > 5.9));
    assert!(refused.to_string().contains("warm up first"), "{refused}");
}

/// The field at 80° north on the equator of longitudes at the beginning of 2025:
/// a test value of the World Magnetic Model's report, 55,178.5 nT.
#[test]
fn a_magnetometer_is_scaled_to_the_model_where_it_is() {
    let kind = GuidedKind::Magnetometer {
        earth: EarthField::InYear(2025.0),
        accelerometer: None,
    };
    let mut hand = Hand::new(&kind);
    hand.earth_ut = [6.5216, 0.1459, 54.7915];
    hand.field = |[x, y, z]| [1.05 * x + 30.0, 0.97 * y + 0.02 * x - 80.0, z + 12.0];
    hand.fix = Some(GnssFix {
        position: Position {
            latitude_rad: 80.0_f64.to_radians(),
            ..Position::default()
        },
        velocity: Velocity::default(),
        ..GnssFix::default()
    });
    hand.tumble(2.0);
    assert!(matches!(hand.calibration.next(), Next::Turn(_)));
    hand.tumble(90.0);
    let found = hand.finish().unwrap();
    let Values::Magnetometer {
        axes,
        mounting,
        strength_ut,
        is_of_model,
    } = found.values
    else {
        panic!("{found:?}");
    };
    assert!((strength_ut - 55.1785).abs() < 1e-3 && is_of_model);
    assert_eq!(mounting, None);
    near(axes.bias, [30.0, -80.0, 12.0], 0.5);
    near(axes.scale, [1.0 / 1.05, 1.0 / 0.97, 1.0], 0.01);
    // The noise is 0.5 µT.
    assert!((0.3..0.8).contains(&found.quality.error), "{found:?}");
}

/// Its axes are turned against the accelerometer's, which is on its side.
#[test]
fn a_magnetometer_is_aligned_with_the_accelerometer() {
    let accelerometer = Axes {
        mounting: "forward-down-left".parse().unwrap(),
        ..Axes::default()
    };
    let kind = GuidedKind::Magnetometer {
        earth: EarthField::Unknown,
        accelerometer: Some(accelerometer),
    };
    let mut hand = Hand::new(&kind);
    // Body y is the accelerometer's -z, and body z its y; the magnetometer is
    // turned by 5° to the right of backward-left-down.
    hand.force = |[x, y, z]| [x, z, -y];
    hand.field = |[x, y, z]| {
        let (sin, cos) = 5.0_f64.to_radians().sin_cos();
        [-cos * x - sin * y, sin * x - cos * y, z]
    };
    hand.tumble(90.0);
    let found = hand.finish().unwrap();
    let Values::Magnetometer {
        mounting: Some((mounting, rotation)),
        strength_ut,
        is_of_model,
        ..
    } = found.values
    else {
        panic!("{found:?}");
    };
    assert_eq!(mounting.to_string(), "backward-left-down");
    let angles = rotation.angles();
    let degrees = [angles.roll_rad, angles.pitch_rad, angles.heading_rad].map(f64::to_degrees);
    near(degrees, [0.0, 0.0, 5.0], 0.3);
    // As measured.
    assert!((strength_ut - 49.66).abs() < 0.5 && !is_of_model);
}

#[test]
fn a_poor_field_is_refused() {
    let kind = |earth| GuidedKind::Magnetometer {
        earth,
        accelerometer: None,
    };
    let known = kind(EarthField::Strength(49.66));
    let mut hand = Hand::new(&known);
    hand.place([0.0, 0.0, -1.0], 10.0);
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::TooFew { needed: 30, .. }));
    // Twice the field: a magnet beneath.
    let mut hand = Hand::new(&known);
    hand.field = |field| field.map(|part| 2.0 * part);
    hand.tumble(90.0);
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::Strength { .. }), "{refused}");
    // A piece of steel that the sensor comes near to and leaves.
    let mut hand = Hand::new(&kind(EarthField::Unknown));
    hand.field = |[x, y, z]| {
        let near = if x > 20.0 { 15.0 } else { 0.0 };
        [x + near, y, z - near]
    };
    hand.tumble(90.0);
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::Poor { .. }), "{refused}");
    // At the end of its range in one direction.
    let mut hand = Hand::new(&kind(EarthField::Unknown));
    hand.field = |[x, y, z]| [x + 790.0, y, z];
    hand.tumble(90.0);
    assert_eq!(hand.finish(), Err(Refusal::Saturated { axis: 0 }));
}

#[test]
fn the_zero_of_a_pitot_tube_is_found_without_wind() {
    let mut hand = Hand::new(&GuidedKind::Airspeed);
    hand.pressure_pa = -12.0;
    hand.hold(of(0.0, 0.0, 0.0), 11.5);
    let found = hand.finish().unwrap();
    let Values::Airspeed { bias_pa } = found.values else {
        panic!("{found:?}");
    };
    // 400 samples of 2 Pa: 0.1 Pa.
    assert!((bias_pa + 12.0).abs() < 0.4, "{bias_pa}");
    // The pressure of 15 m/s at sea level, 1/2 · 1.225 · 15².
    let mut hand = Hand::new(&GuidedKind::Airspeed);
    hand.pressure_pa = 137.8;
    hand.hold(of(0.0, 0.0, 0.0), 11.5);
    assert!(matches!(hand.finish(), Err(Refusal::TooLarge { .. })));
    // A breeze that begins: 5 m/s, 15.3 Pa.
    let mut hand = Hand::new(&GuidedKind::Airspeed);
    for n in 0..460 {
        hand.pressure_pa = if n < 230 { 0.0 } else { 15.3 };
        hand.tick(of(0.0, 0.0, 0.0));
    }
    assert!(matches!(hand.finish(), Err(Refusal::Poor { .. })));
    // It rolls on its wheels.
    let mut hand = Hand::new(&GuidedKind::Airspeed);
    hand.fix = Some(GnssFix {
        velocity: Velocity {
            north_mps: 3.0,
            ..Velocity::default()
        },
        speed_accuracy_mps: 0.1,
        ..GnssFix::default()
    });
    hand.hold(of(0.0, 0.0, 0.0), 11.5);
    assert_eq!(hand.calibration.progress(), 0.0);
}

/// Every right-angled mounting, with a free rotation of some degrees.
#[test]
fn a_mounting_is_found_from_level_and_nose_up() {
    for mounting in Mounting::all() {
        let axes = Axes {
            mounting,
            rotation: Rotation::of_angles(EulerAngles {
                roll_rad: 0.03,
                pitch_rad: -0.05,
                heading_rad: 0.10,
            }),
            ..Axes::default()
        };
        let kind = GuidedKind::Mounting {
            way: MountingWay::LevelAndNoseUp,
            accelerometer: Axes::default(),
        };
        let mut calibration = GuidedCalibration::new(&kind);
        let to_sensor = axes.turn().back();
        let mut now = 0;
        for pitch_deg in [0.0, 10.0, 30.0_f64] {
            for _ in 0..200 {
                now += STEP_NS;
                let attitude = of(0.0, pitch_deg.to_radians(), 1.0);
                let body = earth_to_body(attitude, [0.0, 0.0, -G]);
                let [x_mps2, y_mps2, z_mps2] = to_sensor.turned(body);
                let force = SpecificForce {
                    x_mps2,
                    y_mps2,
                    z_mps2,
                };
                calibration.take(&Measurements {
                    raw_specific_force: Reading::new(force, Time::from_nanos(now)),
                    ..Measurements::default()
                });
            }
            // 10° are too few.
            let expected = if pitch_deg < 20.0 {
                Next::RaiseNose
            } else {
                Next::Done
            };
            assert_eq!(calibration.next(), expected, "{mounting}");
        }
        let Values::Mounting {
            mounting: found,
            rotation,
        } = calibration.finish().unwrap().values
        else {
            panic!("{mounting}");
        };
        assert_eq!(found, mounting);
        near(
            rotation.after(&axes.rotation.back()).0[0],
            [1.0, 0.0, 0.0],
            1e-6,
        );
        near(
            rotation.after(&axes.rotation.back()).0[1],
            [0.0, 1.0, 0.0],
            1e-6,
        );
    }
}

#[test]
fn level_alone_keeps_where_the_sensor_points() {
    let before = Axes {
        mounting: "left-forward-down".parse().unwrap(),
        ..Axes::default()
    };
    let kind = GuidedKind::Mounting {
        way: MountingWay::LevelOnly,
        accelerometer: before,
    };
    let mut hand = Hand::new(&kind);
    // Its y axis points 5° above the aircraft's forward.
    hand.force = |[_, _, z]| {
        let (sin, cos) = 5.0_f64.to_radians().sin_cos();
        [0.0, -sin * z, cos * z]
    };
    hand.hold(of(0.0, 0.0, 0.0), 5.0);
    let found = hand.finish().unwrap();
    let Values::Mounting { mounting, rotation } = found.values else {
        panic!("{found:?}");
    };
    assert_eq!(mounting, before.mounting);
    assert!((rotation.angles().pitch_rad.to_degrees() - 5.0).abs() < 0.1);
    assert!(rotation.angles().heading_rad.abs() < 0.01);
    // An accelerometer that is not calibrated.
    let mut hand = Hand::new(&kind);
    hand.force = |force| force.map(|part| 1.05 * part);
    hand.hold(of(0.0, 0.0, 0.0), 5.0);
    assert!(matches!(hand.finish(), Err(Refusal::Strength { .. })));
}

#[test]
fn a_sensor_that_gives_nothing_is_silent() {
    let mut calibration = GuidedCalibration::new(&GuidedKind::Gyroscope);
    calibration.take(&Measurements::default());
    assert_eq!(calibration.next(), Next::Wait);
    assert_eq!(calibration.finish(), Err(Refusal::Silent));
    assert!(calibration.is_silent());
}

/// Rotations and angles are each other's inverse, as those of
/// `quaternion_from_euler` are.
#[test]
fn the_angles_of_a_rotation_are_those_it_was_made_of() {
    for angles in [[0.1, 0.2, 0.3], [-2.0, 1.2, -3.0], [3.0, -1.5, 1.0]] {
        let [roll_rad, pitch_rad, heading_rad] = angles;
        let rotation = Rotation::of_angles(EulerAngles {
            roll_rad,
            pitch_rad,
            heading_rad,
        });
        let again = rotation.angles();
        let found = [again.roll_rad, again.pitch_rad, again.heading_rad];
        near(found, angles, 1e-12);
        let cosine = 0.5 * ((0..3).map(|n| rotation.0[n][n]).sum::<f64>() - 1.0);
        assert!((rotation.angle_rad() - cosine.acos()).abs() < 1e-12);
        near(
            rotation.back().after(&rotation).0[2],
            [0.0, 0.0, 1.0],
            1e-12,
        );
    }
}

#[test]
fn a_force_that_points_down_is_not_levelled() {
    assert_eq!(levelled([0.0, 0.0, G]), None);
    assert_eq!(levelled([0.0; 3]), None);
    let turned = levelled([G * FRAC_1_SQRT_2, 0.0, -G * FRAC_1_SQRT_2]).unwrap();
    assert!((turned.angle_rad() - PI / 4.0).abs() < 1e-12);
    let attitude = of(0.0, PI / 4.0, 0.0);
    near(
        body_to_earth(attitude, [1.0, 0.0, 0.0]),
        turned.turned([1.0, 0.0, 0.0]),
        1e-12,
    );
}
