//! What is wrong near the ground: wheels, a flare that lasts, ground, a low begin.

use super::*;

/// What the switch says where it cannot be so is not believed; what it does not say is
/// seen by the range finder.
#[test]
fn wheels_that_bear_weight_in_the_air_do_not() {
    let near = |range_m: f64, on_wheels: bool, airspeed_mps: f64| OverGround {
        height_m: Some(range_m),
        on_wheels: Some(on_wheels),
        ..at(-19.08 * (range_m - 1.3), range_m - 1.3, airspeed_mps)
    };
    let mut stuck = landing();
    for (range_m, expected) in [
        (30.0, RunwayPhase::Approach),
        (5.0, RunwayPhase::Flare),
        (2.0, RunwayPhase::Flare),
    ] {
        stuck.advance(&near(range_m, true, 33.0), 0.025);
        assert_eq!(phase(&stuck), Some(expected), "{range_m}");
    }
    stuck.advance(&near(1.4, true, 27.0), 0.025);
    assert_eq!(phase(&stuck), Some(RunwayPhase::RollOut));
    let mut open = landing();
    open.advance(&near(5.0, false, 33.0), 0.025);
    open.advance(&near(1.4, false, 27.0), 0.025);
    assert_eq!(phase(&open), Some(RunwayPhase::RollOut));
}

/// An altimeter that reads 50 m too low flares at 50 m, where the range finder shows
/// nothing. Without a range finder nobody knows.
#[test]
fn a_flare_that_does_not_come_down_is_given_up() {
    for (ranges, expected) in [
        (true, (RunwayPhase::GoAround, RunwayReason::LongFlare)),
        (false, (RunwayPhase::Flare, RunwayReason::None)),
    ] {
        let mut follower = landing();
        for _ in 0..600 {
            let here = OverGround {
                ranges,
                ..at(-120.0, 3.0, 33.0)
            };
            follower.advance(&here, 0.025);
        }
        let flown = (phase(&follower).unwrap(), reason(&follower).unwrap());
        assert_eq!(flown, expected);
    }
}

/// Below the decision height, 200 ft, far before the runway, or below the runway.
#[test]
fn a_landing_that_begins_too_low_climbs_first() {
    for (height_m, expected) in [
        (-280.0, RunwayPhase::GoAround),
        (60.0, RunwayPhase::GoAround),
        (62.0, RunwayPhase::Approach),
    ] {
        assert_eq!(phase(&landing_from(height_m)), Some(expected));
    }
}

/// 1 km before the aim the path is at 52 m, and the ground 8 m below.
#[test]
fn ground_near_the_glide_path_is_gone_around_from() {
    let mut follower = landing();
    let here = OverGround {
        height_m: Some(30.0),
        ..at(-1_000.0, 52.0, 35.0)
    };
    follower.advance(&here, 0.025);
    assert_eq!(phase(&follower), Some(RunwayPhase::Approach));
    let here = OverGround {
        height_m: Some(8.0),
        ..here
    };
    follower.advance(&here, 0.025);
    assert_eq!(reason(&follower), Some(RunwayReason::Ground));
}

/// A landing, 1 km before the aim 52 m above it, with ground so much lower than the runway
/// by the range finder, m; then lower on the path with other ground.
fn over_ground_below(before_m: f64, now_m: f64, north_m: f64, height_m: f64) -> Follower {
    let mut follower = landing();
    for (north_m, height_m, below_m) in [(-1_000.0, 52.0, before_m), (north_m, height_m, now_m)] {
        let here = OverGround {
            height_m: Some(height_m + 1.3 + below_m),
            ranges: true,
            ..at(north_m, height_m, 35.0)
        };
        follower.advance(&here, 0.025);
    }
    follower
}

/// The path of 3° is at 20 m, 380 m before the aim.
#[test]
fn a_range_that_leaves_the_altitude_is_gone_around_from() {
    for (before_m, now_m, expected) in [
        (0.0, 8.0, RunwayReason::RangeJump),
        (0.0, -8.0, RunwayReason::RangeJump),
        (3.0, -12.0, RunwayReason::RangeJump),
        (0.0, 30.0, RunwayReason::RangeJump),
        (0.0, 3.0, RunwayReason::None),
        // An altimeter that is off, and a runway on a plateau.
        (10.0, 10.0, RunwayReason::None),
        (-10.0, -10.0, RunwayReason::None),
        (30.0, 0.0, RunwayReason::None),
        (40.0, 5.0, RunwayReason::None),
    ] {
        let follower = over_ground_below(before_m, now_m, -380.0, 20.0);
        assert_eq!(reason(&follower), Some(expected), "{before_m} {now_m}");
        // Farther away the range finder is not descended by.
        let follower = over_ground_below(before_m, now_m, -800.0, 42.0);
        assert_eq!(
            reason(&follower),
            Some(RunwayReason::None),
            "{before_m} {now_m}"
        );
    }
}

/// In the flare the lower of both is the height.
#[test]
fn in_the_flare_the_lower_one_of_range_and_altitude_counts() {
    for (jump_m, expected_m) in [(3.0, 9.0), (12.0, 6.0), (-5.5, 0.5)] {
        let follower = over_ground_below(0.0, jump_m, -115.0, 6.0);
        let demand = follower.runway().unwrap();
        assert_eq!(demand.reason, RunwayReason::None, "{jump_m}");
        assert!((demand.height_m - expected_m).abs() < 1e-6, "{demand:?}");
    }
}
