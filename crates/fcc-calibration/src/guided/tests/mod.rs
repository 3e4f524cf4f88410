extern crate std;

mod magnetometer;
mod mounting;
mod turning;

use std::string::ToString as _;

use core::f64::consts::{FRAC_1_SQRT_2, PI};

use super::*;
use crate::{AxesCalibration, levelled};
use fcc_core::flight::orientation::{
    EulerAngles, body_to_earth, earth_to_body, quaternion_from_euler,
};
use fcc_core::flight::{BodyRates, GnssFix, MagneticField, Position, SpecificForce, Velocity};
use fcc_core::framework::Reading;

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
    rates: fn([f64; 3]) -> [f64; 3],
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
            rates: |given| given,
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
        let [p, q, r] = (self.rates)([0, 1, 2].map(rate));
        let [bp, bq, br] = self.bias_radps;
        let rates = [p + bp, q + bq, r + br];
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
    let mut hand = Hand::new(&GuidedKind::GyroscopeBias);
    hand.hold(of(0.1, -0.2, 1.0), 5.0);
    assert_eq!(hand.calibration.next(), Next::LeaveAlone);
    hand.tumble(2.0);
    hand.hold(of(0.1, -0.2, 1.0), 11.5);
    let found = hand.finish().unwrap();
    let Values::GyroscopeBias { bias_radps } = found.values else {
        panic!("{found:?}");
    };
    // 400 samples of 0.002 rad/s: 0.0001 rad/s, within 4 standard deviations.
    near(bias_radps, [0.02, -0.01, 0.005], 4e-4);
    assert!((0.5e-4..3e-4).contains(&found.sigma), "{found:?}");
    assert_eq!(hand.calibration.temperature_k(), Some(290.0));
}

#[test]
fn a_gyroscope_that_is_moved_or_turns_is_refused() {
    let mut hand = Hand::new(&GuidedKind::GyroscopeBias);
    for _ in 0..3 {
        hand.hold(of(0.0, 0.0, 0.0), 4.0);
        hand.tumble(1.0);
    }
    assert_eq!(hand.finish(), Err(Refusal::Moved { times: 3 }));
    // 0.5°/s: too slow to be seen by its changes.
    for (axis, name) in [(0, "gravity"), (2, "the field")] {
        let mut hand = Hand::new(&GuidedKind::GyroscopeBias);
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
    let mut hand = Hand::new(&GuidedKind::GyroscopeBias);
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
    let mut hand = Hand::new(&GuidedKind::GyroscopeBias);
    for n in 0..480 {
        hand.temperature_k = 290.0 + 6.0 * f64::from(n) / 480.0;
        hand.tick(of(0.0, 0.0, 0.0));
    }
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::Warmed { by_k } if by_k > 5.9));
    assert!(refused.to_string().contains("warm up first"), "{refused}");
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
