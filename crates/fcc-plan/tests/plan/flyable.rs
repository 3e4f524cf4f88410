//! Speeds, places and altitudes that no aircraft, or not this one, can fly.

use fcc_plan::{
    Altitude, AltitudeDatum, Conditions, Home, Item, Level, Plan, Speed, check, longest_s, read,
};

use crate::place;

const KT: f64 = 1_852.0 / 3_600.0;

/// A Cessna 172: flown between 78 and 120 kt.
pub(crate) const CONDITIONS: Conditions = Conditions {
    airspeed_mps: 100.0 * KT,
    slowest_mps: 78.0 * KT,
    fastest_mps: 120.0 * KT,
    wind_mps: 10.0 * KT,
    bank_rad: 0.52,
    climb_mps: 3.5,
    descent_mps: 5.0,
    loiter_radius_m: 1_000.0,
    final_m: 1_000.0,
    fence_margin_m: None,
};

const fn above_home(m: f64) -> Altitude {
    Altitude {
        m,
        above: AltitudeDatum::Home,
    }
}

fn waypoint(latitude_deg: f64, longitude_deg: f64, m: f64) -> Item {
    Item::Waypoint {
        place: place(latitude_deg, longitude_deg),
        altitude: above_home(m),
        radius_m: None,
    }
}

fn land(latitude_deg: f64) -> Item {
    Item::Land {
        place: Some(place(latitude_deg, 8.0)),
        altitude: above_home(0.0),
        abort_altitude_m: None,
    }
}

const fn speed(speed: Speed) -> Item {
    Item::ChangeSpeed {
        speed: Some(speed),
        throttle_percent: None,
    }
}

/// From home at 45° north and 120 m.
fn plan(items: Vec<Item>) -> Plan {
    Plan {
        home: Some(Home {
            place: place(45.0, 8.0),
            altitude_m: 120.0,
        }),
        items,
        ..Plan::default()
    }
}

fn said(plan: &Plan) -> String {
    let problems = check(plan, &CONDITIONS).err().unwrap_or_default();
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

/// 389 kt: a Cessna has 160 at most. 78 kt are 40.13 m/s, 120 are 61.73.
#[test]
fn a_speed_that_the_aircraft_has_not_is_refused() {
    let with = |first| plan(vec![speed(first), waypoint(45.1, 8.0, 300.0)]);
    let words = "item 1: speed: 200.0 m/s is no airspeed of this aircraft: give 40.1 to 61.7 m/s";
    let refused = said(&with(Speed::AirspeedMps(200.0)));
    assert!(refused.starts_with(words), "{refused}");
    for told in [40.1, 50.0, 61.7] {
        assert_eq!(said(&with(Speed::AirspeedMps(told))), "");
    }
    // With 10 kt from ahead or behind.
    for (mps, permitted) in [(35.0, ""), (66.8, "")] {
        assert_eq!(said(&with(Speed::GroundSpeedMps(mps))), permitted);
    }
    for mps in [34.0, 67.5] {
        let refused = said(&with(Speed::GroundSpeedMps(mps)));
        assert!(
            refused.contains("over the ground is not reached"),
            "{refused}"
        );
    }
    let mut cruise = plan(vec![waypoint(45.1, 8.0, 300.0)]);
    cruise.cruise_mps = Some(15.0);
    let refused = said(&cruise);
    assert!(refused.starts_with("cruiseSpeed: 15.0 m/s"), "{refused}");
}

/// The way from 80° north across the pole is shorter than along the parallel.
#[test]
fn near_a_pole_nothing_is_flown() {
    let refused = said(&plan(vec![waypoint(-89.9, 8.0, 300.0)]));
    assert!(
        refused.contains("item 1: latitude: -89.90° is too near to a pole"),
        "{refused}"
    );
    let mut across = plan(vec![
        waypoint(80.0, 0.0, 300.0),
        waypoint(80.0, 180.0, 300.0),
    ]);
    across.home = Some(Home {
        place: place(79.5, 0.0),
        altitude_m: 0.0,
    });
    let refused = said(&across);
    assert!(
        refused.contains("item 2: latitude: the leg leads to 90.00°"),
        "{refused}"
    );
    across.items[1] = waypoint(80.0, 20.0, 300.0);
    assert_eq!(said(&across), "");
}

#[test]
fn a_runway_without_a_direction_is_refused() {
    let takeoff = |latitude_deg| Item::Takeoff {
        place: Some(place(latitude_deg, 8.0)),
        altitude: above_home(100.0),
        pitch_deg: None,
    };
    let way = waypoint(45.2, 8.0, 300.0);
    let refused = said(&plan(vec![takeoff(45.0), way]));
    assert!(
        refused.starts_with("item 1: place: is 0 m from home"),
        "{refused}"
    );
    // 0.5 m away: a leg that cannot be climbed on is no second problem.
    let refused = said(&plan(vec![takeoff(45.000_005), way]));
    assert_eq!(refused.matches("item 1").count(), 1, "{refused}");
    assert_eq!(said(&plan(vec![takeoff(45.02), way])), "");
    let refused = said(&plan(vec![waypoint(45.1, 8.0, 120.0), way, land(45.2)]));
    assert!(
        refused.contains("item 3: place: is 0 m from the place before"),
        "{refused}"
    );
}

#[test]
fn what_is_below_the_runway_is_said_to_be_below() {
    let refused = said(&plan(vec![waypoint(45.1, 8.0, -840.0), land(45.2)]));
    assert!(
        refused.contains("begins 840 m below the runway"),
        "{refused}"
    );
}

/// Home is at 120 m; -200 m above it are -80 m above the sea.
#[test]
fn items_below_the_elevation_of_home_are_found() {
    let low = plan(vec![
        waypoint(45.1, 8.0, 0.0),
        waypoint(45.2, 8.0, -200.0),
        land(45.3),
    ]);
    let found = Level::lowest_known(&low)
        .unwrap()
        .items_below(&low, "climb");
    let found: Vec<String> = found.iter().map(ToString::to_string).collect();
    let words = "item 2: altitude: -80 m above mean sea level is 200 m below the elevation of \
                 home, 120 m: climb";
    assert_eq!(found, [words]);
}

#[test]
fn a_key_of_ours_that_is_not_known_is_refused() {
    let with = |key: &str| {
        format!(
            "{{\"fileType\": \"Plan\", \"version\": 1, \"mission\": {{\"version\": 2, \"items\": \
             []}}, \"fccd\": {{\"version\": 1, \"{key}\": 5000}}}}"
        )
    };
    assert_eq!(read(&with("floor")).unwrap().fence.floor_m, Some(5_000.0));
    let refused = read(&with("floor_ft")).unwrap_err();
    let refused = refused[0].to_string();
    assert!(
        refused.starts_with("fccd: has a key \"floor_ft\""),
        "{refused}"
    );
}

/// At 100 kt, and 10 kt against it: 11,119 m to the north are 240 s, and back as long; a
/// circle of 1,000 m is 136 s.
#[test]
fn a_plan_has_the_time_for_its_way_back_and_for_other_landings() {
    let there = plan(vec![waypoint(45.1, 8.0, 300.0)]);
    let mut back = there.clone();
    back.items.push(Item::Return);
    let (there_s, back_s) = (
        longest_s(&there, &CONDITIONS),
        longest_s(&back, &CONDITIONS),
    );
    assert!(there_s > 240.0 && there_s < 2.0 * 240.0, "{there_s}");
    assert!(back_s > there_s + 240.0 + 136.0, "{back_s}");
    let only_back = longest_s(&plan(vec![Item::Return]), &CONDITIONS);
    assert!(only_back > 136.0, "{only_back}");
    // A go-around leads there and back, and it is tried three times.
    let mut lands = there;
    lands.items.push(land(45.15));
    let lands_s = longest_s(&lands, &CONDITIONS);
    assert!(lands_s > there_s + 120.0 + 3.0 * 2.0 * 120.0, "{lands_s}");
}

/// Over the ground at 20 m/s 11,119 m take 556 s.
#[test]
fn a_speed_over_the_ground_takes_its_time() {
    let slow = plan(vec![
        speed(Speed::GroundSpeedMps(20.0)),
        waypoint(45.1, 8.0, 300.0),
    ]);
    assert!(longest_s(&slow, &CONDITIONS) > 556.0);
}
