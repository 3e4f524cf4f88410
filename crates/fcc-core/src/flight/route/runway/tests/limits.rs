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
