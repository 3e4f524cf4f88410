//! A gyroscope that is turned over.

use super::*;
use crate::{Mounting, Rotation};
use fcc_core::flight::orientation::product;

/// A scale of 2 % and cross axes of 2 %: the MPU-3050's tolerances (its data
/// sheet, PS-MPU-3050A-00).
fn mpu3050([p, q, r]: [f64; 3]) -> [f64; 3] {
    [
        1.02 * p - 0.02 * q + 0.01 * r,
        0.98 * q + 0.02 * p + 0.015 * r,
        1.01 * r - 0.01 * p - 0.02 * q,
    ]
}

fn kind(turn: Rotation) -> GuidedKind {
    GuidedKind::Gyroscope {
        accelerometer: Axes::default(),
        turn,
    }
}

/// A hand whose gyroscope lay still first.
fn rested() -> Hand {
    let mut hand = Hand::new(&kind(Rotation::NONE));
    hand.hold(of(0.05, -0.03, 0.4), 12.0);
    hand
}

impl Hand {
    /// Turned about one of its axes in 4 s, slowly at the begin and the end, and
    /// laid down.
    fn turn_over(&mut self, axis: u8, angle_rad: f64) {
        let from = self.attitude;
        for n in 1..=160 {
            let share = f64::from(n) / 160.0;
            let (sin, cos) = (0.5 * angle_rad * share * share * (3.0 - 2.0 * share)).sin_cos();
            let [x, y, z] = [0, 1, 2].map(|of| if of == axis { sin } else { 0.0 });
            self.tick(product(from, [cos, x, y, z]));
        }
        self.hold(self.attitude, 3.5);
    }

    /// Does what is asked for; how many turns that took.
    fn turn_as_asked(&mut self) -> u32 {
        let mut turns = 0;
        while let Next::TurnOver { axis, half } = self.calibration.next() {
            self.turn_over(axis, if half { PI } else { 0.5 * PI });
            turns += 1;
            assert!(turns <= 26, "{:?}", self.calibration.coverage());
        }
        turns
    }
}

fn found(hand: &Hand) -> (Axes, f64) {
    let found = hand.finish().unwrap();
    match found.values {
        Values::Gyroscope { axes, .. } => (axes, found.sigma),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_gyroscope_is_calibrated_by_the_turns_it_asks_for() {
    let mut hand = rested();
    hand.rates = mpu3050;
    assert_eq!(
        hand.calibration.next(),
        Next::TurnOver {
            axis: 0,
            half: true
        }
    );
    let turns = hand.turn_as_asked();
    // Nine unknowns, and two angles of each turn.
    assert!((5..=16).contains(&turns), "{turns}");
    assert!(hand.calibration.is_complete() && hand.calibration.progress() == 1.0);
    assert_eq!(hand.calibration.coverage(), Coverage::Turns([1.0; 3]));
    let (axes, sigma) = found(&hand);
    let calibration = AxesCalibration::new(&axes);
    for rates in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        let given = mpu3050(rates).into_iter().zip(axes.bias);
        let [p, q, r] = [(); 3].map({
            let mut given = given.map(|(rate, bias)| rate + bias);
            move |()| given.next().unwrap()
        });
        // 80 samples of 0.03 m/s² in each position: 0.02°, and 0.03 % of the
        // hand's own integration.
        near(calibration.applied([p, q, r]), rates, 1.5e-3);
    }
    near(axes.bias, [0.02, -0.01, 0.005], 4e-4);
    assert!(sigma < 1e-3, "{sigma}");
}

/// It is turned about other axes than those of the accelerometer.
#[test]
fn a_gyroscope_that_is_mounted_otherwise_is_found_in_its_own_axes() {
    let mounting: Mounting = "right-backward-down".parse().unwrap();
    let mut hand = Hand::new(&kind(mounting.rotation()));
    hand.rates = |[p, q, r]| [q, -p, r];
    hand.hold(of(0.05, -0.03, 0.4), 12.0);
    for (axis, quarters) in [
        (0, 2.0),
        (1, 2.0),
        (0, 1.0),
        (0, 2.0),
        (2, 2.0),
        (2, 1.0),
        (1, 2.0),
        (2, 2.0),
        (1, -1.0),
        (0, 2.0),
        (1, 2.0),
    ] {
        hand.turn_over(axis, quarters * 0.5 * PI);
    }
    let (axes, _) = found(&hand);
    near(axes.scale, [1.0; 3], 1.5e-3);
    assert!(
        axes.misalignment.iter().all(|part| part.abs() < 1.5e-3),
        "{axes:?}"
    );
    // As if it were mounted as the accelerometer: it contradicts gravity.
    let mut hand = rested();
    hand.rates = |[p, q, r]| [q, -p, r];
    for _ in 0..4 {
        for (axis, quarters) in [(0, 2.0), (1, 2.0), (0, 1.0), (2, 2.0), (2, 1.0), (1, 2.0)] {
            hand.turn_over(axis, quarters * 0.5 * PI);
        }
    }
    assert_eq!(hand.finish(), Err(Refusal::NotTurned));
}

#[test]
fn turns_about_one_axis_are_not_enough() {
    let mut hand = rested();
    for _ in 0..8 {
        hand.turn_over(0, 0.5 * PI);
    }
    let Coverage::Turns([x, y, z]) = hand.calibration.coverage() else {
        panic!();
    };
    assert!(x == 1.0 && y < 0.01 && z < 0.01, "{x} {y} {z}");
    assert_eq!(hand.finish(), Err(Refusal::TooFew { have: 1, needed: 3 }));
    // About the vertical gravity does not tell anything.
    let mut hand = rested();
    hand.hold(of(0.0, 0.0, 0.4), 3.5);
    for _ in 0..8 {
        hand.turn_over(2, PI);
    }
    assert_eq!(hand.finish(), Err(Refusal::TooFew { have: 0, needed: 3 }));
}

/// It is not laid down for long enough, or not still.
#[test]
fn a_hand_that_trembles_is_refused() {
    let mut hand = rested();
    for n in 0..12 {
        hand.turn_over(n % 3, PI);
        hand.tumble(0.5);
        hand.hold(of(0.0, 0.0, 0.4), 1.2);
    }
    assert!(matches!(hand.finish(), Err(Refusal::Moved { .. })));
    // Before the bias is known.
    let mut hand = Hand::new(&kind(Rotation::NONE));
    for _ in 0..3 {
        hand.hold(of(0.0, 0.0, 0.0), 4.0);
        hand.tumble(1.0);
    }
    assert_eq!(hand.finish(), Err(Refusal::Moved { times: 3 }));
}

/// At the end of its range of 30°/s it shows less than it turns; the half turns
/// of 4 s reach 68°/s.
#[test]
fn a_gyroscope_at_the_end_of_its_range_is_refused() {
    let mut hand = rested();
    hand.rates = |rates| rates.map(|rate| rate.clamp(-0.52, 0.52));
    hand.turn_as_asked();
    let refused = hand.finish().unwrap_err();
    assert!(
        matches!(refused, Refusal::NotTurned | Refusal::Poor { .. }),
        "{refused}"
    );
}

#[test]
fn missing_readings_in_turns_are_said() {
    let mut hand = rested();
    for n in 0..6 {
        hand.now = Time::from_nanos(hand.now.as_nanos() + 200_000_000);
        hand.turn_over(n % 3, PI);
    }
    let refused = hand.finish().unwrap_err();
    assert!(matches!(refused, Refusal::Gaps { .. }), "{refused}");
}
