//! The phases of take-off and landing, with an aircraft that is moved by hand.

use nalgebra::Vector2;

use super::*;
use crate::route::{Follower, OverGround, Route, RouteConfig, Step};
use std::boxed::Box;
use std::vec;
use std::vec::Vec;

mod limits;

const ELEVATION_M: f64 = 120.0;
const NAUTICAL_MILE_M: f64 = 1_852.0;
const FOOT_M: f64 = 0.304_8;
/// Metres per radian of latitude at 45° (WGS-84: 111,131.8 m a degree).
const NORTH_M: f64 = 111_131.8 * 180.0 / core::f64::consts::PI;

/// North of the point that is aimed at, m, at a height above it, m, flying north.
fn at(north_m: f64, height_m: f64, airspeed_mps: f64) -> OverGround {
    OverGround {
        latitude_rad: core::f64::consts::FRAC_PI_4 + north_m / NORTH_M,
        longitude_rad: 0.1,
        altitude_m: ELEVATION_M + height_m,
        ground_velocity_mps: Vector2::new(airspeed_mps, 0.0),
        true_airspeed_mps: airspeed_mps,
        airspeed_mps,
        on_wheels: Some(false),
        ..OverGround::default()
    }
}

fn place(north_m: f64) -> LocalPlane {
    LocalPlane::at(core::f64::consts::FRAC_PI_4 + north_m / NORTH_M, 0.1)
}

fn waypoint(north_m: f64, height_m: f64) -> Step {
    Step::Waypoint {
        at: place(north_m),
        altitude_m: ELEVATION_M + height_m,
        within_m: f64::INFINITY,
    }
}

/// A take-off to the north, to 150 m.
fn takeoff() -> Step {
    Step::Takeoff {
        runway: Some(Runway {
            at: place(0.0),
            course: Vector2::new(1.0, 0.0),
            elevation_m: ELEVATION_M,
        }),
        altitude_m: ELEVATION_M + 150.0,
        pitch_rad: None,
    }
}

fn follower(steps: Vec<Step>, from: usize) -> Follower {
    let route = Route {
        steps: Box::leak(steps.into_boxed_slice()),
        ..Route::default()
    };
    Follower::along(route, from, RouteConfig::default(), 50.0)
}

/// A landing from 6 km before, at 250 m.
fn landing() -> Follower {
    landing_from(250.0)
}

fn landing_from(height_m: f64) -> Follower {
    let land = Step::Land {
        at: place(0.0),
        elevation_m: ELEVATION_M,
        abort_altitude_m: ELEVATION_M + 150.0,
    };
    let steps = vec![
        Step::LandStart,
        waypoint(-6_000.0, 250.0),
        land,
        waypoint(9_000.0, 250.0),
    ];
    let mut follower = follower(steps, 2);
    follower.advance(&at(-6_000.0, height_m, 35.0), 0.025);
    follower
}

fn phase(follower: &Follower) -> Option<RunwayPhase> {
    follower.runway().map(|demand| demand.phase)
}

/// A glide path of 3° descends 318 ft in a nautical mile (FAA-H-8083-16B, chapter 4).
#[test]
fn a_glide_path_of_3_degrees_loses_318_ft_a_mile() {
    let mut follower = landing();
    assert_eq!(phase(&follower), Some(RunwayPhase::Approach));
    follower.advance(&at(-2.0 * NAUTICAL_MILE_M, 194.0, 35.0), 0.025);
    let two_m = follower.altitude_m() - ELEVATION_M;
    follower.advance(&at(-NAUTICAL_MILE_M, 97.0, 35.0), 0.025);
    let one_m = follower.altitude_m() - ELEVATION_M;
    assert!((one_m / FOOT_M - 318.0).abs() < 1.0, "{one_m}");
    assert!(((two_m - one_m) / FOOT_M - 318.0).abs() < 1.0, "{two_m}");
    // On it, the sink rate is that of a table: 368 ft/min at 70 kt.
    let on_path = at(-NAUTICAL_MILE_M, one_m, 70.0 * NAUTICAL_MILE_M / 3_600.0);
    follower.advance(&on_path, 0.025);
    let sink = -follower.runway().unwrap().climb_rate_mps;
    assert!((sink * 60.0 / FOOT_M - 371.0).abs() < 5.0, "{sink}");
}

/// From the glide path to a stop, by the range finder.
#[test]
fn a_landing_is_flared_braked_and_reached() {
    let mut follower = landing();
    let near = |range_m: f64| OverGround {
        height_m: Some(range_m),
        ..at(-50.0, range_m, 35.0)
    };
    follower.advance(&near(12.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Approach));
    follower.advance(&near(4.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Flare));
    let touches = OverGround {
        on_wheels: Some(true),
        ..near(1.3)
    };
    follower.advance(&near(1.6), 0.025);
    let sink_mps = -follower.runway().unwrap().climb_rate_mps;
    assert!(sink_mps < 1.016, "200 ft/min: {sink_mps}");
    follower.advance(&touches, 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::RollOut));
    assert_eq!(follower.reached(), None);
    let stands = OverGround {
        ground_velocity_mps: Vector2::zeros(),
        airspeed_mps: 0.0,
        ..touches
    };
    follower.advance(&stands, 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Stopped));
    assert_eq!(follower.reached(), Some(2));
    follower.advance(&stands, 0.025);
    assert_eq!(
        (phase(&follower), follower.reached()),
        (Some(RunwayPhase::Stopped), None)
    );
}

/// Off the centre line it goes on above 200 ft, and goes around below; at its altitude
/// the sequence begins again.
#[test]
fn a_landing_outside_its_limits_is_given_up() {
    let aside = |north_m: f64, height_m: f64| OverGround {
        longitude_rad: 0.1 + 25.0 / (NORTH_M * core::f64::consts::FRAC_1_SQRT_2),
        ..at(north_m, height_m, 35.0)
    };
    let mut follower = landing();
    follower.advance(&aside(-1_300.0, 68.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Approach));
    follower.advance(&aside(-1_100.0, 58.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::GoAround));
    assert_eq!(follower.altitude_m(), ELEVATION_M + 150.0);
    follower.advance(&at(500.0, 151.0, 38.0), 0.025);
    assert_eq!((phase(&follower), follower.index()), (None, 1));
}

/// 1013 hPa set at 1008 hPa is 43 m off (0.12 hPa a metre). Without a range finder that is
/// given up, with one that shows the ground it is not.
#[test]
fn an_altimeter_that_the_receiver_contradicts_is_not_landed_by() {
    let off = |above_m: f64, range_m: Option<f64>, height_m: f64| OverGround {
        above_receiver_m: Some(above_m),
        height_m: range_m,
        ..at(-height_m / 0.0524, height_m, 35.0)
    };
    for above_m in [43.0, -43.0] {
        let mut follower = landing();
        follower.advance(&off(above_m, None, 200.0), 0.025);
        assert_eq!(phase(&follower), Some(RunwayPhase::Approach));
        follower.advance(&off(above_m, Some(100.0), 100.0), 0.025);
        assert_eq!(phase(&follower), Some(RunwayPhase::Approach));
        follower.advance(&off(above_m, None, 100.0), 0.025);
        let demand = follower.runway().unwrap();
        assert_eq!(
            (demand.phase, demand.reason),
            (RunwayPhase::GoAround, RunwayReason::Receiver)
        );
    }
    let mut follower = landing();
    follower.advance(&off(15.0, None, 100.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Approach));
    // 1031 hPa for 1013: by the receiver it is 50 m over the ground.
    follower.advance(&off(150.0, None, 200.0), 0.025);
    let demand = follower.runway().unwrap();
    assert_eq!(
        (demand.phase, demand.reason),
        (RunwayPhase::GoAround, RunwayReason::Receiver)
    );
}

/// Three landings are given up: then it circles over the runway, and a command is no
/// landing that failed.
#[test]
fn the_third_landing_that_is_given_up_is_the_last() {
    for is_commanded in [false, true] {
        let mut follower = landing();
        for landings in 1..=4 {
            let banked = OverGround {
                roll_rad: 0.5,
                ..at(-1_000.0, 55.0, 35.0)
            };
            if is_commanded {
                follower.go_around(RunwayReason::Commanded);
            }
            follower.advance(&banked, 0.025);
            assert_eq!(phase(&follower), Some(RunwayPhase::GoAround));
            follower.advance(&at(500.0, 151.0, 38.0), 0.025);
            assert_eq!(phase(&follower), None);
            let is_over = !is_commanded && landings == 3;
            assert_eq!(follower.has_no_more_landings(), is_over);
            if is_over {
                assert_eq!(follower.altitude_m(), ELEVATION_M + 150.0);
                assert!(!follower.is_on_leg() && follower.index() == 2);
                break;
            }
            // To the waypoint before it, and onto the approach again.
            follower.advance(&at(-5_900.0, 250.0, 38.0), 0.025);
            follower.advance(&at(-6_001.0, 250.0, 38.0), 0.025);
            for north_m in 0..600 {
                follower.advance(&at(-6_000.0 + f64::from(north_m), 250.0, 38.0), 0.025);
            }
            assert_eq!(phase(&follower), Some(RunwayPhase::Approach));
        }
    }
}

#[test]
fn a_landing_is_given_up_for_its_reason_until_the_wheels_touch() {
    for reason in [RunwayReason::Commanded, RunwayReason::NoPosition] {
        let mut follower = landing();
        follower.go_around(reason);
        let given_up = (phase(&follower), self::reason(&follower));
        assert_eq!(given_up, (Some(RunwayPhase::GoAround), Some(reason)));
    }
    let mut follower = landing();
    let range = OverGround {
        height_m: Some(1.3),
        on_wheels: Some(true),
        ..at(-50.0, 1.3, 33.0)
    };
    follower.advance(&range, 0.025);
    follower.advance(&range, 0.025);
    follower.go_around(RunwayReason::Commanded);
    assert_eq!(phase(&follower), Some(RunwayPhase::RollOut));
}

/// Rolls, rotates at 55 kt, climbs, and goes on with the plan at its altitude.
#[test]
fn a_take_off_goes_on_with_the_plan() {
    let mut follower = follower(vec![takeoff(), waypoint(8_000.0, 250.0)], 0);
    let rolls = |knots: f64| OverGround {
        on_wheels: Some(true),
        ..at(100.0, 0.0, knots * NAUTICAL_MILE_M / 3_600.0)
    };
    follower.advance(&rolls(0.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Roll));
    follower.advance(&rolls(54.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Roll));
    follower.advance(&rolls(56.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Rotate));
    follower.advance(&at(600.0, 4.0, 33.0), 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Climb));
    follower.advance(&at(2_500.0, 149.0, 38.0), 0.025);
    assert_eq!((phase(&follower), follower.reached()), (None, Some(0)));
    assert_eq!(follower.index(), 1);
}

/// One that does not reach its altitude goes on with the plan after 120 s, from 45 m on.
#[test]
fn a_climb_without_the_power_for_it_ends() {
    for (height_m, ends) in [(40.0, false), (60.0, true)] {
        let mut follower = follower(vec![takeoff(), waypoint(8_000.0, 250.0)], 0);
        follower.advance(&at(600.0, height_m, 33.0), 0.025);
        for (seconds, expected) in [(119, Some(RunwayPhase::Climb)), (2, None)] {
            for _ in 0..seconds * 40 {
                follower.advance(&at(2_500.0, height_m, 33.0), 0.025);
            }
            let expected = expected.or((!ends).then_some(RunwayPhase::Climb));
            assert_eq!(phase(&follower), expected, "{height_m}");
            let lacks_power = follower.runway().is_some_and(|demand| demand.lacks_power);
            assert_eq!(lacks_power, seconds == 2 && !ends);
        }
    }
}

/// One that leaves the centre line by 12 m brakes.
#[test]
fn a_take_off_beside_the_centre_line_is_given_up() {
    let mut follower = follower(vec![takeoff()], 0);
    let rolls = OverGround {
        on_wheels: Some(true),
        longitude_rad: 0.1 + 13.0 / (NORTH_M * core::f64::consts::FRAC_1_SQRT_2),
        ..at(100.0, 0.0, 20.0)
    };
    follower.advance(&rolls, 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::RollOut));
}

fn reason(follower: &Follower) -> Option<RunwayReason> {
    follower.runway().map(|demand| demand.reason)
}

/// By the phase and its reason; at last it stands, and no item is reached.
#[test]
fn a_take_off_needs_the_runways_direction_and_its_elevation() {
    // 1 hPa is 27 ft, and a compass errs by some degrees.
    for (heading_deg, height_m, expected) in [
        (15.0_f64, 16.0, RunwayReason::None),
        (-90.0, 0.0, RunwayReason::Alignment),
        (180.0, 0.0, RunwayReason::Alignment),
        (0.0, 62.0, RunwayReason::Altimeter),
    ] {
        let mut follower = follower(vec![takeoff(), waypoint(8_000.0, 250.0)], 0);
        let stands = OverGround {
            on_wheels: Some(true),
            heading_rad: heading_deg.to_radians(),
            ..at(0.0, height_m, 0.0)
        };
        for _ in 0..3 {
            follower.advance(&stands, 0.025);
            assert_eq!(follower.reached(), None);
        }
        assert_eq!(reason(&follower), Some(expected));
        let takes_off = phase(&follower) == Some(RunwayPhase::Roll);
        assert_eq!(takes_off, expected == RunwayReason::None);
    }
}

/// Commanded or restarted elsewhere than on the approach, it flies the approach first, and
/// lands in the direction of its leg.
#[test]
fn a_landing_begins_with_its_approach() {
    let from = |here: OverGround| {
        let land = Step::Land {
            at: place(0.0),
            elevation_m: ELEVATION_M,
            abort_altitude_m: ELEVATION_M + 150.0,
        };
        let mut follower = follower(vec![waypoint(-6_000.0, 250.0), land], 1);
        follower.advance(&here, 0.025);
        (phase(&follower), follower.index())
    };
    // After a restart at 40 m, 10 m off the line.
    let aside = OverGround {
        longitude_rad: 0.1 + 10.0 / (NORTH_M * core::f64::consts::FRAC_1_SQRT_2),
        ..at(-763.0, 40.0, 35.0)
    };
    assert_eq!(from(aside), (Some(RunwayPhase::Approach), 1));
    let across = OverGround {
        ground_velocity_mps: Vector2::new(0.0, 35.0),
        ..at(-763.0, 40.0, 35.0)
    };
    assert_eq!(from(across), (None, 0));
    assert_eq!(from(at(50.0, 40.0, 35.0)), (None, 0));
}
