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

/// The airspeed shows 0 on the wheels where the wind of 25 kt overtakes the aircraft.
#[test]
fn on_the_wheels_the_wind_is_the_one_of_the_flare() {
    let tail = |on_wheels: bool, wind_mps: f64| OverGround {
        height_m: Some(1.3),
        on_wheels: Some(on_wheels),
        ground_velocity_mps: Vector2::new(40.0, 0.0),
        wind_mps: Vector2::new(wind_mps, 0.0),
        ..at(-50.0, 0.0, 27.0)
    };
    let mut follower = landing();
    follower.advance(&tail(false, 12.9), 0.025);
    follower.advance(&tail(true, 12.9), 0.025);
    follower.advance(&tail(true, 2.0), 0.025);
    let demand = follower.runway().unwrap();
    assert_eq!(demand.phase, RunwayPhase::RollOut);
    assert!((demand.head_wind_mps + 12.9).abs() < 1e-3, "{demand:?}");
}

/// A range finder that reads 1.2 m too much is overruled by wheels that bear weight for a
/// second at less than flying speed, and not in a sink: there the switch is stuck.
#[test]
fn wheels_that_roll_overrule_a_range_finder() {
    for (airspeed_mps, climb_rate_mps, expected) in [
        (27.0, 0.0, RunwayPhase::RollOut),
        (30.0, 0.0, RunwayPhase::Flare),
        (27.0, -1.1, RunwayPhase::Flare),
    ] {
        let mut follower = landing();
        let rolls = OverGround {
            height_m: Some(2.5),
            on_wheels: Some(true),
            climb_rate_mps,
            ..at(-50.0, 0.0, airspeed_mps)
        };
        follower.advance(&rolls, 0.025);
        for tick in 0..44 {
            follower.advance(&rolls, 0.025);
            assert!(tick > 36 || phase(&follower) == Some(RunwayPhase::Flare));
        }
        assert_eq!(
            phase(&follower),
            Some(expected),
            "{airspeed_mps} {climb_rate_mps}"
        );
    }
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

/// Without a range finder it sinks with at most 150 ft/min, as on glassy water (FAA-H-8083-23,
/// chapter 6), from 20 ft above the runway on, and higher with the path's 365: by the receiver,
/// whatever the altimeter shows.
#[test]
fn an_uncertain_height_is_sunk_through_slowly() {
    for off_m in [-9.0, 0.0, 9.0] {
        let mut follower = landing();
        for (height_m, slow) in [(30.0, false), (14.0, false), (5.0, true), (0.2, true)] {
            let here = OverGround {
                above_receiver_m: Some(off_m),
                ..at(-height_m / 0.0524, height_m + off_m, 35.0)
            };
            (0..2).for_each(|_| follower.advance(&here, 0.025));
            let sink_fpm = -follower.runway().unwrap().climb_rate_mps * 60.0 / FOOT_M;
            assert_eq!(sink_fpm < 150.0, slow, "{off_m} {height_m} {sink_fpm}");
            assert!(sink_fpm > 100.0, "{off_m} {height_m} {sink_fpm}");
        }
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

/// On the wheels, with speeds over the ground and through the air, m/s.
fn rolling(over_ground_mps: f64, airspeed_mps: f64) -> OverGround {
    OverGround {
        ground_velocity_mps: Vector2::new(over_ground_mps, 0.0),
        on_wheels: Some(true),
        ..at(100.0, 0.0, airspeed_mps)
    }
}

/// A take-off after so many ticks of 25 ms with this.
fn takes_off(here: &OverGround, ticks: usize) -> Follower {
    let mut follower = follower(vec![takeoff(), waypoint(8_000.0, 250.0)], 0);
    follower.advance(&rolling(0.0, 0.0), 0.025);
    for _ in 0..ticks {
        follower.advance(here, 0.025);
    }
    follower
}

/// 35 kt over the ground with 5 kt through the air are more than a tail wind of 15 kt; with
/// 22 kt, or for a second only, they are not.
#[test]
fn an_airspeed_that_stays_behind_gives_a_take_off_up_early() {
    let given_up = (Some(RunwayPhase::RollOut), Some(RunwayReason::NoAirspeed));
    let rolls = (Some(RunwayPhase::Roll), Some(RunwayReason::None));
    for (over_ground_mps, airspeed_mps, ticks, expected) in [
        (18.0, 2.6, 42, given_up),
        (18.0, 2.6, 36, rolls),
        (18.0, 11.3, 400, rolls),
        (28.0, 20.4, 400, rolls),
        (28.0, 20.2, 42, given_up),
        // Too slow for the tube to show much.
        (16.0, 0.0, 400, rolls),
    ] {
        let follower = takes_off(&rolling(over_ground_mps, airspeed_mps), ticks);
        let what = (phase(&follower), reason(&follower));
        assert_eq!(what, expected, "{over_ground_mps} {airspeed_mps} {ticks}");
    }
}

/// Off the ground it is a climb, whatever the airspeed; by the switch, or by height and climb
/// rate. A steep runway, and an aircraft that is slow over the ground, are none.
#[test]
fn a_take_off_that_flies_is_not_braked() {
    use RunwayPhase::{Climb, Roll, Rotate};
    let off = |on_wheels, height_m: f64, climb_rate_mps, airspeed_mps| OverGround {
        on_wheels,
        climb_rate_mps,
        ground_velocity_mps: Vector2::new(31.0, 0.0),
        ..at(300.0, height_m, airspeed_mps)
    };
    for (here, expected, is_wrong) in [
        (off(Some(false), 1.5, 0.5, 4.0), Climb, true),
        (off(Some(false), 1.5, 0.5, 26.0), Rotate, false),
        (off(None, 4.0, 2.0, 4.0), Climb, true),
        // The switch is stuck.
        (off(Some(true), 4.0, 2.0, 4.0), Climb, true),
        (off(Some(true), 4.0, 2.0, 26.0), Roll, false),
        (off(Some(true), 4.0, 0.6, 26.0), Roll, false),
        (off(Some(false), 0.5, 0.6, 26.0), Roll, false),
        (
            OverGround {
                ground_velocity_mps: Vector2::new(20.0, 0.0),
                ..off(Some(false), 1.5, 0.5, 15.0)
            },
            Roll,
            false,
        ),
    ] {
        let demand = takes_off(&here, 22).runway().unwrap();
        let shown = (demand.phase, demand.airspeed_is_wrong);
        assert_eq!(shown, (expected, is_wrong), "{here:?}");
        assert_eq!(demand.reason, RunwayReason::None);
    }
}

/// It was given up at the moment at which it lifts off: it flies on, unless its engine is out.
#[test]
fn a_take_off_that_is_given_up_too_late_flies_on() {
    for (given_up_for, expected) in [
        (None, RunwayPhase::Climb),
        (Some(RunwayReason::Engine), RunwayPhase::RollOut),
    ] {
        let mut follower = takes_off(&rolling(28.0, 5.0), 20);
        match given_up_for {
            Some(reason) => follower.go_around(reason),
            None => (0..22).for_each(|_| follower.advance(&rolling(28.0, 5.0), 0.025)),
        }
        assert_eq!(phase(&follower), Some(RunwayPhase::RollOut));
        for _ in 0..22 {
            let here = OverGround {
                ground_velocity_mps: Vector2::new(31.0, 0.0),
                ..at(300.0, 1.5, 5.0)
            };
            follower.advance(&here, 0.025);
        }
        assert_eq!(phase(&follower), Some(expected));
    }
}

/// 890 ft to 55 kt (handbook of the 172P, 1981, section 5) are 19 s at constant acceleration.
/// Without power, or without way, it is given up in less than a minute.
#[test]
fn a_take_off_that_does_not_reach_its_speed_is_given_up() {
    use RunwayReason::{LongRoll, None};
    for (mps, seconds, expected) in [
        (0.0, 30, None),
        (0.0, 60, LongRoll),
        (2.0, 30, None),
        (2.0, 60, LongRoll),
    ] {
        let follower = takes_off(&rolling(mps, mps), seconds * 40);
        assert_eq!(reason(&follower), Some(expected), "{mps} {seconds}");
    }
}

/// Rotates at 29 m/s and 300 m, so far off the line, m, and rolls on, climbs for 12 s over a
/// switch that is stuck, or has lifted off and is down again.
#[test]
fn a_take_off_that_stays_on_its_wheels_is_given_up() {
    use RunwayPhase::{Climb, RollOut, Rotate};
    use RunwayReason::{CentreLine, NoLiftOff, None};
    let rolls = |east_m: f64, climb_rate_mps: f64| OverGround {
        longitude_rad: 0.1 + east_m / (NORTH_M * core::f64::consts::FRAC_1_SQRT_2),
        climb_rate_mps,
        ..rolling(29.0, 29.0)
    };
    for (east_m, climb_rate_mps, seconds, expected) in [
        (0.0, 0.0, 9, (Rotate, None)),
        (0.0, 0.0, 11, (RollOut, NoLiftOff)),
        (0.0, 1.5, 12, (Rotate, None)),
        (13.0, 1.5, 2, (Rotate, None)),
        (13.0, 0.0, 2, (RollOut, CentreLine)),
    ] {
        let mut follower = takes_off(&rolls(0.0, 0.0), 1);
        for _ in 0..seconds * 40 {
            follower.advance(&rolls(east_m, climb_rate_mps), 0.025);
        }
        let what = (phase(&follower).unwrap(), reason(&follower).unwrap());
        assert_eq!(what, expected, "{east_m} {climb_rate_mps} {seconds}");
    }
    let mut follower = takes_off(&rolls(0.0, 0.0), 1);
    follower.advance(&at(300.0, 4.0, 29.0), 0.025);
    assert_eq!(phase(&follower), Some(Climb));
    for _ in 0..11 * 40 {
        follower.advance(&rolls(0.0, 0.0), 0.025);
    }
    assert_eq!(reason(&follower), Some(NoLiftOff));
}
