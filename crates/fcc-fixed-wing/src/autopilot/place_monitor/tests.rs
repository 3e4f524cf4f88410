//! Positions of an aircraft that flies north, and of receivers that fail.

use super::*;

const DT_S: f64 = 0.025;
const STALL_AND_MORE_MPS: f64 = 30.0;

/// 100 m north in this latitude, rad (a degree is 111 km).
const NORTH_100_M: f64 = 100.0 / 111_175.0 * core::f64::consts::PI / 180.0;

/// Each value of a tick from 0 on: the place (100 m north), the velocity (m/s north),
/// the airspeed (m/s), whether the wheels bear weight.
type Flown = (f64, f64, f64, bool);

/// The doubt in each tick of `seconds` in which time passes by `dt_s`.
fn doubts(seconds: f64, dt_s: f64, flown: impl Fn(f64) -> Flown) -> [Option<PlaceDoubt>; 1200] {
    let mut monitor = PlaceMonitor::new(STALL_AND_MORE_MPS);
    let mut doubts = [None; 1200];
    let mut expected = None;
    for (n, doubt) in doubts.iter_mut().enumerate() {
        let at_s = n as f64 * DT_S;
        if at_s >= seconds {
            break;
        }
        let taken = Time::from_nanos((n as i64 + 1) * 25_000_000);
        let (north, speed_mps, airspeed_mps, on_wheels) = flown(at_s);
        let velocity = Velocity {
            north_mps: speed_mps,
            ..Velocity::default()
        };
        monitor.take_velocity(&Reading::new(velocity, taken));
        let ground = Vector2::new(speed_mps, 0.0);
        monitor.advance(ground, || Vector2::new(airspeed_mps, 0.0), dt_s);
        let position = Position {
            latitude_rad: 0.82 + north * NORTH_100_M,
            longitude_rad: 0.14,
            altitude_m: 900.0,
        };
        let off_m = expected.map(|was: f64| 100.0 * (north - was) - speed_mps * dt_s);
        let moving = Moving {
            on_wheels,
            airspeed_mps,
            ground_mps: speed_mps,
            off_m: off_m.map(f64::abs),
        };
        let verdict = monitor.judge(&Reading::new(position, taken), &moving);
        if matches!(verdict, Verdict::Use) {
            expected = Some(north);
        }
        *doubt = monitor.doubt();
    }
    doubts
}

/// When it is first doubted, s, and when the last doubt ends.
fn doubted_s(doubts: &[Option<PlaceDoubt>]) -> Option<(f64, f64)> {
    let first = doubts.iter().position(Option::is_some)?;
    let last = doubts.iter().rposition(Option::is_some)?;
    Some((first as f64 * DT_S, last as f64 * DT_S))
}

/// 50 m/s, with a velocity that changes a little, as all that is measured.
fn flies(at_s: f64) -> Flown {
    (0.5 * at_s, 50.0 + 1e-6 * libm::sin(at_s), 50.0, false)
}

#[test]
fn what_moves_as_it_says_or_stands_on_its_wheels_is_believed() {
    assert_eq!(doubted_s(&doubts(30.0, DT_S, flies)), None);
    // One place a second, read in each tick.
    let slow = |at_s| (0.5 * libm::floor(at_s), 50.0 + 1e-6 * at_s, 50.0, false);
    assert_eq!(doubted_s(&doubts(30.0, DT_S, slow)), None);
    // On the runway in a storm; held in a head wind of 50 m/s by a velocity near 0.
    let stands = |_| (0.0, 0.0, 35.0, true);
    assert_eq!(doubted_s(&doubts(30.0, DT_S, stands)), None);
    let hovers = |at_s| (0.0, 0.1 * libm::sin(at_s), 50.0, false);
    assert_eq!(doubted_s(&doubts(30.0, DT_S, hovers)), None);
    // Without weight on wheels, slower than it flies.
    let tied = |_| (0.0, 0.0, 15.0, false);
    assert_eq!(doubted_s(&doubts(30.0, DT_S, tied)), None);
}

/// The plant's time stands still.
#[test]
fn a_pause_repeats_nothing() {
    let paused = |_| (0.0, 50.0, 50.0, false);
    assert_eq!(doubted_s(&doubts(30.0, 0.0, paused)), None);
}

/// From 10 to 20 s; believed again after two times of 4 s that are good, which begin at
/// the end of one that is not.
#[test]
fn a_repeated_place_is_left_and_comes_back() {
    for velocity_is_repeated in [false, true] {
        let flown = |at_s: f64| {
            let held_s = if (10.0..20.0).contains(&at_s) {
                10.0
            } else {
                at_s
            };
            let (north, ..) = flies(held_s);
            let (_, speed_mps, airspeed_mps, _) =
                flies(if velocity_is_repeated { held_s } else { at_s });
            (north, speed_mps, airspeed_mps, false)
        };
        let (first_s, last_s) = doubted_s(&doubts(34.0 - 4.1, DT_S, flown)).unwrap();
        assert!((11.5..13.2).contains(&first_s), "{first_s}");
        assert!((27.9..=29.9).contains(&last_s), "{last_s}");
    }
}

/// By 400 m: left at once. One that stays is believed after 8 s, in which it moves.
#[test]
fn a_jump_is_left_until_it_has_moved_as_the_aircraft() {
    let jumped = |at_s: f64| {
        let (north, speed_mps, airspeed_mps, on_wheels) = flies(at_s);
        let by = if at_s >= 10.0 { 4.0 } else { 0.0 };
        (north + by, speed_mps, airspeed_mps, on_wheels)
    };
    let all = doubts(30.0, DT_S, jumped);
    let (first_s, last_s) = doubted_s(&all).unwrap();
    assert!((first_s - 10.0).abs() < 0.05, "{first_s}");
    assert!((17.9..18.2).contains(&last_s), "{last_s}");
    assert!(all.contains(&Some(PlaceDoubt::Jumps)));
}

/// Knots are not metres a second: the place agrees with airspeed and heading.
#[test]
fn a_wrong_velocity_is_not_held_against_the_place() {
    let wrong = |at_s| {
        let (north, speed_mps, airspeed_mps, on_wheels) = flies(at_s);
        (north, 1.944 * speed_mps, airspeed_mps, on_wheels)
    };
    assert_eq!(doubted_s(&doubts(30.0, DT_S, wrong)), None);
}
