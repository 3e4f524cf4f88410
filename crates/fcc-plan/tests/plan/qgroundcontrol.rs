//! Files of QGroundControl, present and older, and what it requires of ours.
//!
//! Keys and versions by its sources (`src/MissionManager` and `src/QmlControls`):
//! `PlanMasterController`, `MissionController`, `MissionItem`,
//! `LandingComplexItem`, `TransectStyleComplexItem`, `GeoFenceController`,
//! `QGCFencePolygon`, `QGCMapCircle`, `RallyPointController`.

use fcc_plan::{
    Altitude, AltitudeDatum, Circle, Format, Item, Loiter, LoiterEnd, Plan, Polygon, RallyPoint,
    read, write,
};
use serde_json::Value;

use crate::place;

/// A plan of these items, and of these sections beside the mission.
fn text(items: &str, sections: &str) -> String {
    format!(
        r#"{{"fileType": "Plan", "groundStation": "QGroundControl", "version": 1, {sections}
           "mission": {{"version": 2, "firmwareType": 12, "items": [{items}],
           "plannedHomePosition": [45.0, 8.0, 120.0]}}}}"#
    )
}

const fn above_home(m: f64) -> Altitude {
    Altitude {
        m,
        above: AltitudeDatum::Home,
    }
}

/// What QGroundControl requires of an object, at the place in the file.
const REQUIRED: [(&str, &[&str]); 8] = [
    (
        "",
        &[
            "fileType",
            "groundStation",
            "version",
            "mission",
            "geoFence",
            "rallyPoints",
        ],
    ),
    (
        "/mission",
        &["plannedHomePosition", "items", "firmwareType"],
    ),
    (
        "/mission/items/0",
        &["type", "frame", "command", "params", "autoContinue"],
    ),
    ("/geoFence", &["version", "circles", "polygons"]),
    ("/geoFence/polygons/0", &["version", "inclusion", "polygon"]),
    ("/geoFence/circles/0", &["inclusion", "circle"]),
    ("/geoFence/circles/0/circle", &["center", "radius"]),
    ("/rallyPoints", &["version", "points"]),
];

#[test]
fn what_is_written_has_every_key_that_qgroundcontrol_requires() {
    let mut plan = Plan::default();
    plan.items.push(Item::Waypoint {
        place: place(45.0, 8.0),
        altitude: above_home(300.0),
        radius_m: None,
    });
    plan.fence.polygons.push(Polygon {
        corners: vec![place(45.0, 8.0), place(45.1, 8.0), place(45.1, 8.1)],
        inclusion: true,
        group: 0,
    });
    plan.fence.circles.push(Circle {
        centre: place(45.0, 8.0),
        radius_m: 300.0,
        inclusion: false,
        group: 0,
    });
    plan.rally.push(RallyPoint {
        place: place(45.0, 8.0),
        altitude_m: 90.0,
    });
    let written = write(&plan, Format::QgcPlan).unwrap();
    let value: Value = serde_json::from_str(&written).unwrap();
    for (place, keys) in REQUIRED {
        let object = value.pointer(place).unwrap().as_object().unwrap();
        for key in keys {
            assert!(object.contains_key(*key), "{place}: {key}");
        }
    }
    let count = |place: &str| value.pointer(place).unwrap().as_array().unwrap().len();
    // Altitudes where they are required, and only there.
    assert_eq!(count("/mission/plannedHomePosition"), 3);
    assert_eq!(count("/mission/items/0/params"), 7);
    assert_eq!(count("/geoFence/polygons/0/polygon/0"), 2);
    assert_eq!(count("/geoFence/circles/0/circle/center"), 2);
    assert_eq!(count("/rallyPoints/points/0"), 3);
    assert_eq!(read(&written).unwrap().home, None);
}

/// Version 1 of fence and rally points is ignored there; here only where it has nothing.
#[test]
fn sections_of_version_1_are_read_if_they_are_empty() {
    let waypoint = r#"{"type": "SimpleItem", "autoContinue": true, "command": 16, "doJumpId": 1,
        "frame": 3, "params": [0, 0, 0, null, 45.05, 8.0, 300]}"#;
    for sections in [
        r#""geoFence": {"polygon": [], "version": 1}, "rallyPoints": {"points": [], "version": 2},"#,
        r#""geoFence": {}, "rallyPoints": {},"#,
        r#""geoFence": {"version": 1, "polygon": [],
            "parameters": [{"compId": 1, "name": "FENCE_ACTION", "value": 1}]},"#,
        r#""geoFence": null, "rallyPoints": {"version": 1},"#,
        r#""geoFence": {"version": 2, "circles": [], "breachReturn": [0, 0, 0],
            "polygons": [{"version": 1, "inclusion": true, "polygon": []}]},"#,
        "",
    ] {
        let plan = read(&text(waypoint, sections)).unwrap();
        assert!(plan.fence.is_empty() && plan.rally.is_empty(), "{sections}");
    }
    for (sections, expected) in [
        (
            r#""geoFence": {"polygon": [[45, 8], [46, 8], [46, 9]], "version": 1},"#,
            "geoFence: has \"polygon\" and is of version 1 or none, which QGroundControl ignores",
        ),
        (
            r#""rallyPoints": {"points": [[45, 8, 50]], "version": 1},"#,
            "rallyPoints: has \"points\" and is of version 1 or none",
        ),
        (
            r#""geoFence": {"version": 3},"#,
            "geoFence.version: 3: only version 2",
        ),
        (
            r#""geoFence": {"version": 1, "breachReturn": [45, 8, 50]},"#,
            "geoFence: has \"breachReturn\" and is of version 1",
        ),
        // A fence that is not read is not there, and nobody sees it.
        (
            r#""geofence": {"version": 2, "circles": []},"#,
            "the file: has a key \"geofence\": write \"geoFence\"",
        ),
        (
            r#""geoFence": {"version": 2, "polygon": [[45, 8], [46, 8], [46, 9]]},"#,
            "geoFence: has a key \"polygon\", and there is none of this name",
        ),
        (
            r#""geoFence": {"version": 2, "polygons": [{"inclusive": false,
                "polygon": [[45, 8], [46, 8], [46, 9]]}]},"#,
            "geoFence.polygons[0]: has a key \"inclusive\"",
        ),
        (
            r#""geoFence": {"version": 2, "breachReturn": "here"},"#,
            "geoFence.breachReturn: give a list",
        ),
    ] {
        let problems = read(&text(waypoint, sections)).unwrap_err();
        assert!(
            problems[0].to_string().starts_with(expected),
            "{problems:?}"
        );
    }
}

/// `MissionController.cc` looks for the first item with the number of a jump.
#[test]
fn a_jump_to_one_of_two_items_with_its_number_is_to_the_first() {
    let waypoint = |north: f64| {
        format!(
            r#"{{"type": "SimpleItem", "command": 16, "doJumpId": 7, "frame": 3,
                "params": [0, 0, 0, null, {north}, 8.0, 300]}},"#
        )
    };
    let jump = r#"{"type": "SimpleItem", "command": 177, "doJumpId": 8, "frame": 2,
        "params": [7, 1, 0, 0, 0, 0, 0]}"#;
    let items = format!("{}{}{jump}", waypoint(45.05), waypoint(45.1));
    let plan = read(&text(&items, "")).unwrap();
    assert!(matches!(plan.items[2], Item::Jump { to: 1, .. }));
}

#[test]
fn an_item_with_a_coordinate_and_four_parameters() {
    let expected = Item::Waypoint {
        place: place(45.05, 8.0),
        altitude: above_home(300.0),
        radius_m: Some(60.0),
    };
    for item in [
        r#"{"type": "SimpleItem", "autoContinue": true, "command": 16, "doJumpId": 1, "frame": 3,
            "params": [0, 60, 0, 0], "coordinate": [45.05, 8.0, 300]}"#,
        r#"{"type": "missionItem", "autoContinue": true, "command": 16, "id": 1, "frame": 3,
            "param1": 0, "param2": 60, "param3": 0, "param4": 0, "coordinate": [45.05, 8.0, 300]}"#,
        r#"{"type": "SimpleItem", "autoContinue": true, "command": 16, "doJumpId": 1, "frame": 3,
            "params": [0, 60, 0, 0, 45.05, 8.0, 300], "coordinate": [1, 2, 3]}"#,
    ] {
        assert_eq!(read(&text(item, "")).unwrap().items, [expected]);
    }
    let flat = r#"{"type": "SimpleItem", "command": 16, "frame": 3, "params": [0, 0, 0, 0],
        "coordinate": [45.05, 8.0]}"#;
    let said = read(&text(flat, "")).unwrap_err()[0].to_string();
    let expected =
        "item 1: mission.items[0].coordinate: give 7 numbers, or 4 and a coordinate of 3";
    assert_eq!(said, expected);
}

/// `loiterCoordinate` until 4.0, `landingApproachCoordinate` since; version 1 has a datum for
/// each of both places.
#[test]
fn a_landing_pattern_of_each_version() {
    let pattern = |version: u8, keys: &str| {
        let item = format!(
            r#"{{"type": "ComplexItem", "complexItemType": "fwLandingPattern", "version": {version},
                "landCoordinate": [45.0, 8.0, 0], "loiterRadius": 750, "loiterClockwise": true,
                {keys}}}"#
        );
        read(&text(&item, ""))
    };
    let expected = |above: AltitudeDatum| {
        let approach = Item::Loiter(Loiter {
            place: Some(place(44.95, 8.02)),
            altitude: Altitude { m: 120.0, above },
            radius_m: Some(750.0),
            clockwise: true,
            end: LoiterEnd::Altitude,
            leave_towards_next: true,
        });
        let land = Item::Land {
            place: Some(place(45.0, 8.0)),
            altitude: above_home(0.0),
            abort_altitude_m: None,
        };
        [Item::LandStart { place: None }, approach, land]
    };
    let home = expected(AltitudeDatum::Home);
    let at = r#""loiterCoordinate": [44.95, 8.02, 120]"#;
    let old = pattern(2, &format!(r#"{at}, "altitudesAreRelative": true"#));
    assert_eq!(old.unwrap().items, home);
    let present =
        r#""landingApproachCoordinate": [44.95, 8.02, 120], "altitudesAreRelative": true"#;
    assert_eq!(pattern(2, present).unwrap().items, home);
    let first = r#""loiterAltitudeRelative": false, "landAltitudeRelative": true"#;
    let first = pattern(1, &format!("{at}, {first}"));
    assert_eq!(first.unwrap().items, expected(AltitudeDatum::SeaLevel));
    let said = pattern(3, present).unwrap_err()[0].to_string();
    assert_eq!(said, "item 1: mission.items[0].version: 3: give 1 or 2");
}

/// The items of a survey are numbered on, and its camera's commands are kept.
#[test]
fn a_survey_is_the_items_that_it_contains() {
    let items = r#"
        {"type": "ComplexItem", "complexItemType": "survey", "version": 5, "angle": 0,
         "TransectStyleComplexItem": {"version": 1, "CameraShots": 2, "Items": [
            {"type": "SimpleItem", "autoContinue": true, "command": 16, "doJumpId": 1, "frame": 3,
             "params": [0, 0, 0, null, 45.05, 8.0, 300]},
            {"type": "SimpleItem", "autoContinue": true, "command": 206, "doJumpId": 2, "frame": 2,
             "params": [25, 0, 1, 0, 0, 0, null]}]}},
        {"type": "SimpleItem", "autoContinue": true, "command": 177, "doJumpId": 3, "frame": 2,
         "params": [4, 1, 0, 0, 0, 0, 0]},
        {"type": "SimpleItem", "autoContinue": true, "command": 20, "doJumpId": 4, "frame": 2,
         "params": [0, 0, 0, 0, 0, 0, 0]}"#;
    let waypoint = Item::Waypoint {
        place: place(45.05, 8.0),
        altitude: above_home(300.0),
        radius_m: None,
    };
    let camera = Item::Camera {
        command: 206,
        frame: 2,
        parameters: [25.0, 0.0, 1.0, 0.0, 0.0, 0.0, f64::NAN]
            .map(|p| Some(p).filter(|p| !p.is_nan())),
    };
    let jump = Item::Jump {
        to: 4,
        times: Some(1),
    };
    let plan = read(&text(items, "")).unwrap();
    assert_eq!(plan.items, [waypoint, camera, jump, Item::Return]);
    let refused = items.replace("\"command\": 206", "\"command\": 84");
    let said = read(&text(&refused, "")).unwrap_err()[0].to_string();
    assert!(
        said.starts_with("item 2: command: 84 is not supported"),
        "{said}"
    );
}
