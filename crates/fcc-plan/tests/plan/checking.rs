//! Plans that cannot be flown, and why.

use fcc_plan::{
    Altitude, AltitudeDatum, Circle, Conditions, Home, Item, Loiter, LoiterEnd, Obstacle, Plan,
    Polygon, check, read,
};
use proptest::prelude::*;

use crate::any_plan::any_plan;
use crate::place;

const KT: f64 = 1_852.0 / 3_600.0;

fn conditions(wind_kt: f64) -> Conditions {
    Conditions {
        airspeed_mps: 100.0 * KT,
        slowest_mps: 78.0 * KT,
        fastest_mps: 120.0 * KT,
        wind_mps: wind_kt * KT,
        bank_rad: 30.0_f64.to_radians(),
        climb_mps: 3.5,
        descent_mps: 5.0,
        loiter_radius_m: 1_000.0,
        final_m: 1_000.0,
        fence_margin_m: Some(30.0),
    }
}

const fn sea_level(m: f64) -> Altitude {
    Altitude {
        m,
        above: AltitudeDatum::SeaLevel,
    }
}

/// North along a meridian from 60° north, km apart, at 1,000 m: a minute of latitude
/// is 1,861 m there.
fn waypoint(latitude_deg: f64, longitude_deg: f64, altitude_m: f64) -> Item {
    Item::Waypoint {
        place: place(latitude_deg, longitude_deg),
        altitude: sea_level(altitude_m),
        radius_m: None,
    }
}

fn plan(longitude_deg: f64) -> Plan {
    Plan {
        home: Some(Home {
            place: place(60.0, longitude_deg),
            altitude_m: 1_000.0,
        }),
        items: vec![
            waypoint(60.1, longitude_deg, 1_000.0),
            waypoint(60.1, longitude_deg + 0.2, 1_100.0),
            waypoint(60.0, longitude_deg + 0.2, 1_000.0),
        ],
        ..Plan::default()
    }
}

fn said(plan: &Plan, wind_kt: f64) -> String {
    let problems = check(plan, &conditions(wind_kt)).expect_err("no problem");
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

fn loiter(radius_m: f64) -> Item {
    Item::Loiter(Loiter {
        place: Some(place(60.05, 8.2)),
        altitude: sea_level(1_000.0),
        radius_m: Some(radius_m),
        clockwise: true,
        end: LoiterEnd::Turns(1.0),
        leave_towards_next: false,
    })
}

/// 100 kt, 30°, 15 kt: (115 kt)²/(g tan 30°) = 618.2 m.
#[test]
fn a_loiter_is_refused_with_the_smallest_radius_of_this_wind() {
    let mut plan = plan(8.0);
    plan.items.push(loiter(750.0));
    assert_eq!(check(&plan, &conditions(15.0)), Ok(()));
    plan.items.push(loiter(600.0));
    let said = said(&plan, 15.0);
    assert!(
        said.starts_with("item 5: radius: 600 m is too small"),
        "{said}"
    );
    assert!(said.ends_with("give at least 619 m"), "{said}");
}

/// The same for the circle after the last waypoint, of the usual radius.
#[test]
fn the_circle_that_ends_a_plan_is_refused_if_it_cannot_be_flown() {
    let small = Conditions {
        loiter_radius_m: 600.0,
        ..conditions(15.0)
    };
    let refused = check(&plan(8.0), &small).unwrap_err();
    assert_eq!(refused.len(), 1);
    let said = refused[0].to_string();
    assert!(said.starts_with("item 3: plan.loiter_radius_m, of the circle after it: 600 m is too"));
    assert!(said.ends_with("give at least 619 m"), "{said}");
    let enough = Conditions {
        loiter_radius_m: 619.0,
        ..small
    };
    assert_eq!(check(&plan(8.0), &enough), Ok(()));
}

#[test]
fn a_turn_needs_room_and_a_climb_time() {
    assert_eq!(check(&plan(8.0), &conditions(20.0)), Ok(()));
    let mut short = plan(8.0);
    // 558 m to the east, and back: 180° need 2 R behind the waypoint.
    short.items[1] = waypoint(60.1, 8.01, 1_000.0);
    short.items[2] = waypoint(60.1, 8.0, 1_000.0);
    let said_of_turn = said(&short, 20.0);
    assert!(
        said_of_turn.contains("item 1: turn: the turn needs"),
        "{said_of_turn}"
    );
    let mut steep = plan(8.0);
    steep.items[1] = waypoint(60.1, 8.2, 2_000.0);
    let said_of_climb = said(&steep, 0.0);
    // 11,174 m (60.1° north) at 51.44 m/s: 217 s for 1,000 m.
    assert!(
        said_of_climb.contains("a climb of 4.6 m/s"),
        "{said_of_climb}"
    );
}

/// The same fence around the same plan, at Greenwich and across the date line.
#[test]
fn the_fence_is_kept_across_the_date_line_as_well() {
    for longitude in [8.0, 179.9] {
        let mut plan = plan(longitude);
        let wrapped = |by: f64| (longitude + by + 540.0).rem_euclid(360.0) - 180.0;
        for item in &mut plan.items {
            if let Item::Waypoint { place, .. } = item {
                place.longitude_deg = wrapped(place.longitude_deg - longitude);
            }
        }
        plan.fence.polygons.push(Polygon {
            corners: vec![
                place(59.9, wrapped(-0.1)),
                place(60.2, wrapped(-0.1)),
                place(60.2, wrapped(0.3)),
                place(59.9, wrapped(0.3)),
            ],
            inclusion: true,
            group: 0,
        });
        assert_eq!(check(&plan, &conditions(20.0)), Ok(()), "{longitude}");
        plan.items[1] = Item::Waypoint {
            place: place(60.1, wrapped(0.4)),
            altitude: sea_level(1_000.0),
            radius_m: None,
        };
        let said = said(&plan, 20.0);
        assert!(said.contains("item 2: fence"), "{said}");
        assert!(said.contains("outside of the fence"), "{said}");
    }
}

/// A circle of 3 km inside a polygon of 44 km: PX4 and `ArduPilot` keep both, and MAVLink's
/// groups make it one of them.
#[test]
fn of_several_zones_all_are_kept_and_of_several_groups_one() {
    let with_group = |group: u16| {
        format!(
            "QGC WPL 110\n0 1 0 16 0 0 0 0 45.05 8 120 1\n\
             1 0 3 16 0 0 0 0 45.05 8 300 1\n2 0 3 16 0 0 0 0 45.05 8.1 300 1\n\
             3 0 0 5001 4 {group} 0 0 44.8 7.8 0 1\n4 0 0 5001 4 {group} 0 0 45.3 7.8 0 1\n\
             5 0 0 5001 4 {group} 0 0 45.3 8.3 0 1\n6 0 0 5001 4 {group} 0 0 44.8 8.3 0 1\n\
             7 0 0 5003 3000 0 0 0 45.05 8 0 1\n"
        )
    };
    let conditions = conditions(10.0);
    let both = read(&with_group(0)).unwrap();
    let said = check(&both, &conditions).unwrap_err();
    assert!(
        said.iter().any(|problem| problem.item == Some(2)),
        "{said:?}"
    );
    let either = read(&with_group(1)).unwrap();
    assert_eq!(check(&either, &conditions), Ok(()));
    let unequal = with_group(0).replacen("5001 4 0", "5001 4 2", 1);
    let said = read(&unequal).unwrap_err()[0].to_string();
    assert!(
        said.contains("line 6: parameter 2 (inclusion group): 0: the corners before have 2"),
        "{said}"
    );
}

#[test]
fn circles_ceilings_and_obstacles() {
    let mut fenced = plan(8.0);
    fenced.fence.circles.push(Circle {
        centre: place(60.05, 8.0),
        radius_m: 200.0,
        inclusion: false,
        group: 0,
    });
    assert!(said(&fenced, 0.0).contains("item 1: fence"));
    let mut low = plan(8.0);
    low.fence.ceiling_m = Some(1_050.0);
    assert!(said(&low, 0.0).contains("item 2: fence: 1100 m is above its ceiling, 1050 m"));
    let mut mast = plan(8.0);
    mast.obstacles.push(Obstacle {
        centre: place(60.05, 8.001),
        radius_m: 100.0,
        top_m: 1_010.0,
    });
    assert!(said(&mast, 0.0).contains("item 1: obstacle: the leg comes within 56 m"));
    // In 20 kt the arc of 841 m passes the corner 348 m to the south-east; and the circle
    // after the last item is 1,000 m wide.
    for (at, expected) in [
        (
            place(60.1, 8.0).ahead(135.0, 348.0),
            "item 1: obstacle: in the turn",
        ),
        (
            place(60.0, 8.2).ahead(70.0, 1_000.0),
            "item 3: obstacle: on the circle",
        ),
    ] {
        let mut mast = plan(8.0);
        mast.obstacles.push(Obstacle {
            centre: at,
            radius_m: 20.0,
            top_m: 1_200.0,
        });
        let said = said(&mast, 20.0);
        assert!(said.contains(expected), "{said}");
    }
}

/// Where no leg leads, at home and "here", and by a change of altitude.
#[test]
fn heights_of_items_without_a_leg_are_those_of_the_fence() {
    let here = |m: f64| {
        Item::Loiter(Loiter {
            place: None,
            altitude: sea_level(m),
            radius_m: None,
            clockwise: true,
            end: LoiterEnd::Altitude,
            leave_towards_next: false,
        })
    };
    let change = |m: f64| Item::ChangeAltitude {
        altitude: sea_level(m),
    };
    for (item, is_permitted) in [
        (here(1_200.0), true),
        (here(1_400.0), false),
        (here(800.0), false),
        (change(1_200.0), true),
        (change(1_400.0), false),
    ] {
        let mut plan = plan(8.0);
        plan.items.insert(0, item);
        (plan.fence.floor_m, plan.fence.ceiling_m) = (Some(900.0), Some(1_300.0));
        let problems = check(&plan, &conditions(0.0)).err().unwrap_or_default();
        let of_it = problems.iter().any(|problem| problem.item == Some(1));
        assert_eq!(of_it, !is_permitted, "{item:?} {problems:?}");
    }
    let mut narrow = plan(8.0);
    (narrow.fence.floor_m, narrow.fence.ceiling_m) = (Some(1_000.0), Some(900.0));
    assert!(said(&narrow, 0.0).contains("the ceiling, 900 m, is -100 m above the floor"));
}

#[test]
fn jumps_end_and_altitudes_are_known() {
    let mut plan = plan(8.0);
    plan.items.push(Item::Jump {
        to: 9,
        times: Some(1),
    });
    plan.items.push(Item::Jump { to: 1, times: None });
    plan.items.push(Item::Jump {
        to: 6,
        times: Some(1),
    });
    plan.items.push(Item::ChangeAltitude {
        altitude: Altitude {
            m: 100.0,
            above: AltitudeDatum::Terrain,
        },
    });
    let said = said(&plan, 0.0);
    for expected in [
        "item 4: jump: to 9: there is no such item: give 1 to 7",
        "item 6: jump: to 6: nothing is flown between",
        "item 7: altitude: is above terrain",
    ] {
        assert!(said.contains(expected), "{expected}: {said}");
    }
    assert!(!said.contains("item 5"), "{said}");
}

/// What is behind a jump for ever is reached by a command: no leg leads there. The leg would
/// descend from 3,000 to 130 m within 2.8 km (47°: 111,170 m for a degree of latitude).
#[test]
fn no_leg_leads_from_a_jump_for_ever_to_the_landing_behind_it() {
    let with = |times: i32| {
        let text = format!(
            "QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 100 1\n\
             1 0 0 16 0 0 0 0 47 8 3000 1\n2 0 0 16 0 0 0 0 47.2 8 3000 1\n\
             3 0 2 177 1 {times} 0 0 0 0 0 1\n4 0 2 189 0 0 0 0 0 0 0 1\n\
             5 0 0 16 0 0 0 0 47.225 8 230 1\n6 0 0 21 0 0 0 0 47.25 8 100 1\n"
        );
        check(&read(&text).unwrap(), &conditions(10.0))
    };
    assert_eq!(with(-1), Ok(()));
    let once = with(1).unwrap_err();
    assert!(
        once.iter().all(|problem| problem.item == Some(5)),
        "{once:?}"
    );
}

#[test]
fn a_fence_alone_is_no_plan_and_says_so() {
    let fence = read("QGC WPL 110\n0 0 0 5003 2000 0 0 0 47 8 0 1\n").unwrap();
    let said = said(&fence, 0.0);
    let expected = "items: there are none, but a fence or rally points: put these behind the items";
    assert!(said.starts_with(expected), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    /// Any plan, anywhere: it ends, without a panic, and no number is not one.
    #[test]
    fn any_plan_is_checked(plan in any_plan(), wind_kt in 0.0..150.0_f64) {
        if let Err(problems) = check(&plan, &conditions(wind_kt)) {
            for problem in problems {
                prop_assert!(!problem.message.contains("NaN"), "{}", problem);
            }
        }
    }
}

/// Landing to the south: 111,412 m for a degree of latitude at 60° (WGS-84).
#[test]
fn a_landing_needs_its_last_leg_and_is_the_end() {
    let land = |latitude_deg: f64| Item::Land {
        place: Some(place(latitude_deg, 8.2)),
        altitude: sea_level(950.0),
        abort_altitude_m: None,
    };
    let mut landing = plan(8.0);
    landing.items.push(land(60.0 - 1.2 / 60.0));
    assert_eq!(check(&landing, &conditions(0.0)), Ok(()));
    // Straight on for half a minute of latitude.
    *landing.items.last_mut().unwrap() = land(60.0 - 0.5 / 60.0);
    let problems = said(&landing, 0.0);
    let straight = "item 4: approach: the leg to the landing is straight for 928 m";
    assert!(problems.contains(straight), "{problems}");
    // From 1,000 m down to a runway at 980 m.
    *landing.items.last_mut().unwrap() = Item::Land {
        place: Some(place(60.0 - 1.2 / 60.0, 8.2)),
        altitude: sea_level(980.0),
        abort_altitude_m: None,
    };
    let problems = said(&landing, 0.0);
    let low = "item 4: approach: the leg to the landing begins 20 m above the runway";
    assert!(problems.contains(low), "{problems}");
    *landing.items.last_mut().unwrap() = land(60.0 - 1.2 / 60.0);
    landing.items.push(waypoint(59.9, 8.2, 1_000.0));
    let problems = said(&landing, 0.0);
    assert!(
        problems.contains("item 5 is behind a landing"),
        "{problems}"
    );
    let mut returning = plan(8.0);
    returning.items.push(Item::Return);
    assert_eq!(check(&returning, &conditions(0.0)), Ok(()));
    returning.items.push(waypoint(60.0, 8.2, 1_000.0));
    let problems = said(&returning, 0.0);
    assert!(problems.contains("item 5 is behind a return"), "{problems}");
}

#[test]
fn a_landing_without_a_place_needs_a_take_off() {
    let mut back = plan(8.0);
    back.items.push(Item::Land {
        place: None,
        altitude: sea_level(0.0),
        abort_altitude_m: None,
    });
    let problems = said(&back, 0.0);
    let lacks = "item 4: place: without a place it lands where it took off, and no take-off is";
    assert!(problems.contains(lacks), "{problems}");
    let takeoff = Item::Takeoff {
        place: None,
        altitude: sea_level(1_100.0),
        pitch_deg: None,
    };
    back.items.insert(0, takeoff);
    assert_eq!(check(&back, &conditions(0.0)), Ok(()));
}

/// 30 m above home are needed.
#[test]
fn a_take_off_climbs_before_it_turns() {
    let mut low = plan(8.0);
    for (altitude_m, is_refused) in [(1_029.0, true), (1_031.0, false)] {
        let takeoff = Item::Takeoff {
            place: Some(place(60.05, 8.0)),
            altitude: sea_level(altitude_m),
            pitch_deg: None,
        };
        low.items.insert(0, takeoff);
        let problems = check(&low, &conditions(0.0)).err().unwrap_or_default();
        let of_it = problems.iter().any(|problem| problem.item == Some(1));
        assert_eq!(of_it, is_refused, "{problems:?}");
        low.items.remove(0);
    }
}
