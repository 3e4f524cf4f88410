//! Files as ground stations write them.

use std::fmt::Write as _;

use fcc_plan::{
    Altitude, AltitudeDatum, Circle, Item, Loiter, LoiterEnd, Plan, RallyPoint, Speed, read,
};

use crate::place;

const LANDING: &str = include_str!("../files/landing.plan");
const LOITER: &str = include_str!("../files/loiter.waypoints");

const fn above_home(m: f64) -> Altitude {
    Altitude {
        m,
        above: AltitudeDatum::Home,
    }
}

#[test]
fn a_plan_of_qgroundcontrol_with_comments_and_a_landing_pattern() {
    let plan = read(LANDING).unwrap();
    let home = plan.home.unwrap();
    assert_eq!(home.place, place(47.397_743_2, 8.545_594_2));
    assert_eq!(home.altitude_m, 488.1);
    assert_eq!(plan.cruise_mps, Some(25.0));
    let items = [
        Item::Takeoff {
            place: Some(place(47.398_509_9, 8.545_100_2)),
            altitude: above_home(50.0),
            pitch_deg: Some(15.0),
        },
        Item::Waypoint {
            place: place(47.41, 8.60),
            altitude: above_home(120.0),
            radius_m: Some(40.0),
        },
        Item::Jump {
            to: 2,
            times: Some(1),
        },
        Item::LandStart { place: None },
        Item::Loiter(Loiter {
            place: Some(place(47.41, 8.52)),
            altitude: above_home(80.0),
            radius_m: Some(250.0),
            clockwise: false,
            end: LoiterEnd::Altitude,
            leave_towards_next: true,
        }),
        Item::Land {
            place: Some(place(47.398_5, 8.545)),
            altitude: above_home(0.0),
            abort_altitude_m: None,
        },
    ];
    assert_eq!(plan.items, items);
    assert_eq!(plan.fence.polygons.len(), 1);
    assert!(plan.fence.polygons[0].inclusion);
    assert_eq!(plan.fence.polygons[0].corners[2], place(47.5, 8.7));
    let outside = Circle {
        centre: place(47.402, 8.566),
        radius_m: 900.5,
        inclusion: false,
        group: 0,
    };
    assert_eq!(plan.fence.circles, [outside]);
    assert_eq!(plan.fence.return_point, Some((place(47.39, 8.55), 120.0)));
    let rally = RallyPoint {
        place: place(47.42, 8.58),
        altitude_m: 100.0,
    };
    assert_eq!(plan.rally, [rally]);
}

/// Spaces instead of tabs, an empty line, a comment, and the line ends of
/// Windows, as in files in use.
#[test]
fn a_text_of_mission_planner_with_odd_spacing() {
    let plan = read(LOITER).unwrap();
    assert_eq!(plan.home.unwrap().altitude_m, 584.0);
    let items = [
        Item::Takeoff {
            place: None,
            altitude: above_home(50.0),
            pitch_deg: Some(15.0),
        },
        Item::Waypoint {
            place: place(-35.35, 149.165),
            altitude: above_home(100.0),
            radius_m: Some(60.0),
        },
        Item::Loiter(Loiter {
            place: Some(place(-35.34, 149.18)),
            altitude: Altitude {
                m: 120.0,
                above: AltitudeDatum::Terrain,
            },
            radius_m: Some(150.0),
            clockwise: false,
            end: LoiterEnd::Turns(2.0),
            leave_towards_next: true,
        }),
        Item::ChangeSpeed {
            speed: Some(Speed::AirspeedMps(22.0)),
            throttle_percent: None,
        },
        Item::Jump { to: 2, times: None },
    ];
    assert_eq!(plan.items[..5], items);
    assert_eq!(plan.items.len(), 8);
}

#[test]
fn a_fence_and_rally_points_of_a_text() {
    let corner =
        |n: usize, id: u16, latitude: f64| format!("{n} 0 0 {id} 3 0 0 0 {latitude} 8.5 0 1\n");
    let mut text = String::from("QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 430 1\n");
    for n in 0..6_usize {
        let id = if n < 3 { 5_001 } else { 5_002 };
        text += &corner(n + 1, id, 47.0 + n as f64);
    }
    text += "7 0 0 5004 250 0 0 0 47.1 8.1 0 1\n8 0 3 5100 0 0 0 0 47.2 8.2 90 1\n";
    let Plan { fence, rally, .. } = read(&text).unwrap();
    let inclusions = fence
        .polygons
        .iter()
        .map(|p| (p.inclusion, p.corners.len()));
    assert!(inclusions.eq([(true, 3), (false, 3)]));
    assert_eq!(fence.polygons[1].corners[0], place(50.0, 8.5));
    assert_eq!(fence.circles[0].radius_m, 250.0);
    assert_eq!(rally[0].altitude_m, 90.0);
}

/// As `fence save` and `rally save` of MAVProxy write them, without home.
#[test]
fn a_fence_alone_and_rally_points_alone() {
    let text = "QGC WPL 110\n\
        0\t0\t0\t5000\t0.000000\t0.0\t0.0\t0.0\t47.05\t8.05\t0.000000\t0\n\
        1\t0\t0\t5001\t3.000000\t0.0\t0.0\t0.0\t47.0\t8.0\t0.0\t0\n\
        2\t0\t0\t5001\t3.000000\t0.0\t0.0\t0.0\t47.1\t8.0\t0.0\t0\n\
        3\t0\t0\t5001\t3.000000\t0.0\t0.0\t0.0\t47.1\t8.1\t0.0\t0\n";
    let plan = read(text).unwrap();
    assert_eq!((plan.home, plan.items.len()), (None, 0));
    let corners = [place(47.0, 8.0), place(47.1, 8.0), place(47.1, 8.1)];
    assert_eq!(plan.fence.polygons[0].corners, corners);
    assert_eq!(plan.fence.return_point, Some((place(47.05, 8.05), 0.0)));
    let rally = "QGC WPL 110\n0\t0\t3\t5100\t0.0\t0.0\t0.0\t0.0\t47.2\t8.2\t90.0\t0\n";
    assert_eq!(read(rally).unwrap().rally[0].altitude_m, 90.0);
    // The same as older versions saved them.
    let old = "47.05\t8.05\n47.0\t8.0\n47.1\t8.0\n47.1\t8.1\n47.0\t8.0\n";
    assert_eq!(read(old).unwrap().fence, plan.fence);
    let old = "RALLY 47.200000\t8.200000\t90.000000\t40.000000\t0.000000\t0\n";
    assert_eq!(read(old).unwrap(), read(rally).unwrap());
}

/// 800 items, as the largest files in use have, and 1,000, the limit.
#[test]
fn a_long_plan_and_one_that_is_too_long() {
    let lines = |count: usize| {
        let mut text = String::from("QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 430 1\n");
        for n in 1..=count {
            let longitude = 8.0 + n as f64 * 0.01;
            let _ = writeln!(text, "{n} 0 3 16 0 0 0 0 47.5 {longitude} 100 1");
        }
        text
    };
    assert_eq!(read(&lines(800)).unwrap().items.len(), 800);
    assert_eq!(read(&lines(1_000)).unwrap().items.len(), 1_000);
    let problems = read(&lines(1_001)).unwrap_err();
    assert!(
        problems[0].to_string().contains("more than 1000"),
        "{problems:?}"
    );
}
