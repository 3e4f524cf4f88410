//! What is refused, and how it is said: item, field, what to do.

use std::fmt::Write as _;

use fcc_plan::{Format, Obstacle, Plan, read, read_file, write};

use crate::place;

/// What is said of a text with this line as item 1.
fn of_line(line: &str) -> String {
    let text = format!("QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 430 1\n{line}\n");
    said(&text)
}

fn said(text: &str) -> String {
    let problems = read(text).expect_err(text);
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

/// A plan with this mission item.
fn of_item(item: &str) -> String {
    said(&format!(
        r#"{{"fileType": "Plan", "version": 1, "mission": {{"version": 2, "items": [{item}]}}}}"#
    ))
}

#[test]
fn a_line_says_item_field_and_what_to_do() {
    let cases = [
        (
            "1 0 3 16 0 0 0 0 91 8 100 1",
            "item 1: line 3: latitude: 91: give -90 to 90",
        ),
        (
            "1 0 3 16 0 0 0 0 47 181 100 1",
            "item 1: line 3: longitude: 181: give -180 to 180",
        ),
        (
            "1 0 3 16 0 0 0 0 47 8 20001 1",
            "altitude: 20001: give -1000 to 20000",
        ),
        (
            "1 0 3 16 0 0 0 0 0 0 100 1",
            "place: latitude and longitude are missing or 0",
        ),
        (
            "1 0 1 16 0 0 0 0 47 8 100 1",
            "frame: 1: give 0 (above sea level), 3",
        ),
        (
            "1 0 3 16 30 0 0 0 47 8 100 1",
            "parameter 1 (hold): 30 s: an aeroplane cannot stop",
        ),
        (
            "1 0 3 16 0 0 0 0 47 8 100",
            "line 3: has 11 numbers: give 12",
        ),
        (
            "1 0 3 16 0 0 0 0 47 8 100 1 1",
            "line 3: has more than 12 numbers: give 12",
        ),
        (
            "1 0 3 16 0 0 0 0 47 8 high 1",
            "altitude: \"high\": give a number",
        ),
        (
            "1 0 3 16 0 0 0 0 47 8 inf 1",
            "altitude: \"inf\": give a number",
        ),
        (
            "2 0 3 16 0 0 0 0 47 8 100 1",
            "index: 2: this line is number 1",
        ),
        (
            "1 0 3 22 0.26 0 0 0 0 0 100 1",
            "parameter 1 (pitch): 0.26: too little to lift off: give 2 to 45 degrees (0.26 rad are 15°)",
        ),
        (
            "1 0 3 22 1.5 0 0 0 0 0 100 1",
            "parameter 1 (pitch): 1.5: too little to lift off: give 2 to 45 degrees",
        ),
        (
            "1 0 3 84 0 0 0 0 47 8 100 1",
            "command: 84 is not supported",
        ),
        (
            "1 0 3 18 0 0 50 0 47 8 100 1",
            "parameter 1 (turns): 0: give the number of turns",
        ),
        (
            "1 0 3 177 1.5 0 0 0 0 0 0 1",
            "parameter 1 (item): 1.5: give a whole number",
        ),
        (
            "1 0 3 178 0 500 -1 0 0 0 0 1",
            "parameter 2 (speed, m/s): 500: give 1 to 350",
        ),
        ("1 0 3 178 0 20 -1 1 0 0 0 1", "parameter 4 (relative)"),
        (
            "1 0 0 5001 3 0 0 0 47 8 0 1",
            "fence: the polygon lacks 2 corners",
        ),
        (
            "1 0 0 5003 0 0 0 0 47 8 0 1",
            "parameter 1 (radius): 0: give the radius",
        ),
    ];
    for (line, expected) in cases {
        let said = of_line(line);
        assert!(said.contains(expected), "{line}: {said}");
    }
}

#[test]
fn what_has_no_target_or_place_is_refused_by_both() {
    let said_of_jump = of_line("1 0 3 177 7 1 0 0 0 0 0 1");
    assert_eq!(
        said_of_jump,
        "item 1: parameter 1 (item): 7: there is no such item: give 1 to 1"
    );
    let said_of_rally = of_line("1 0 0 5100 0 0 0 0 47 8 90 1");
    assert!(
        said_of_rally.contains("frame: a rally point is above home"),
        "{said_of_rally}"
    );
    let plan = r#"{"fileType": "Plan", "version": 1,
        "mission": {"version": 2, "items": [], "plannedHomePosition": [0, 0, 0]},
        "rallyPoints": {"version": 2, "points": [[0, 0, 50]]}}"#;
    assert_eq!(
        said(plan),
        "rallyPoints.points[0]: 0, 0 means that it is not set: give a place"
    );
}

/// The files of PX4 and MAVROS begin with the first item; home is above sea level, has
/// command 16 and no parameters, and its place is 0, 0 where it is not set.
#[test]
fn a_first_item_in_line_0_is_not_taken_for_home() {
    let cases = [
        (
            "0 1 3 16 0 0 0 0 47 8 300 1",
            "frame: 3 is not above sea level (0)",
        ),
        (
            "0 1 10 16 0 0 0 0 47 8 300 1",
            "frame: 10 is not above sea level (0)",
        ),
        ("0 1 0 22 15 0 0 0 47 8 300 1", "command: 22 is not 16"),
        ("0 1 0 16 0 25 0 0 47 8 300 1", "parameter 2: 25 is not 0"),
    ];
    for (line, expected) in cases {
        let said = said(&format!("QGC WPL 110\n{line}\n"));
        assert!(
            said.starts_with(&format!("line 2: {expected}, and line 0 is home")),
            "{line}: {said}"
        );
        assert!(said.contains("put home before it"), "{said}");
    }
    for line in ["0 1 0 16 0 0 0 0 47 8 430 1", "0 1 3 0 0 0 0 0 0 0 0 1"] {
        assert!(read(&format!("QGC WPL 110\n{line}\n")).is_ok(), "{line}");
    }
    let old = said("QGC WPL 120\n0 1 3 22 0 0 0 0 47 8 300 1\n");
    let expected = "line 1: version 120 has no home: write QGC WPL 110, put home before the items";
    assert!(old.starts_with(expected), "{old}");
    // Lines without content are counted, too.
    let third = said("# of a field\n\nQGC WPL 100\n");
    assert!(third.starts_with("line 3: version 100"), "{third}");
    let first = said("QGC WPL 100\n");
    assert!(
        first.starts_with("line 1: version 100: only QGC WPL 110 is read"),
        "{first}"
    );
}

#[test]
fn an_old_fence_or_rally_file_says_what_it_lacks() {
    let open = "47 8\n47 8.1\n47.1 8.1\n47.1 8\n";
    assert!(said(open).starts_with("is no fence of MAVProxy: give the place to return to"));
    let word = "47 8\n47 8.1\n47.1 8.1 9\n";
    assert_eq!(
        said(word),
        "line 3: \"47.1 8.1 9\": give latitude and longitude"
    );
    let place = "47 8\n97 8.1\n47.1 8.1\n47.1 8\n97 8.1\n";
    assert_eq!(said(place), "line 2: latitude: 97: give -90 to 90");
    let short = "RALLY 47 8 100\n";
    assert!(said(short).starts_with("line 1: \"47 8 100\": give RALLY, latitude"));
    let back = "QGC WPL 110\n0 0 0 5000 0 0 0 0 47 8 120 1\n";
    assert_eq!(
        said(back),
        "line 2: frame: a place to return to is above home: give 3"
    );
}

#[test]
fn all_problems_are_listed() {
    let lines =
        "1 0 3 16 0 0 0 0 95 8 100 1\n2 0 3 16 0 0 0 0 47 8 100 1\n3 0 3 99 0 0 0 0 47 8 100 1";
    let said = of_line(lines);
    assert_eq!(said.lines().count(), 2, "{said}");
    assert!(said.contains("item 3: line 5: command: 99"), "{said}");
    // A jump over and to what is refused has its target.
    let jump =
        "1 0 3 99 0 0 0 0 47 8 100 1\n2 0 2 177 3 1 0 0 0 0 0 1\n3 0 3 99 0 0 0 0 47 8 100 1";
    assert!(!of_line(jump).contains("item 2"), "{}", of_line(jump));
}

#[test]
fn a_plan_of_json_says_where() {
    let cases = [
        (
            r#"{"type": "ComplexItem", "complexItemType": "StructureScan"}"#,
            "item 1: mission.items[0].type: \"StructureScan\" is not supported",
        ),
        (
            r#"{"type": "ComplexItem", "complexItemType": "survey", "version": 3}"#,
            "item 1: mission.items[0].type: lacks \"TransectStyleComplexItem\", which has its \
             items: open the file with a present QGroundControl and save it again",
        ),
        (
            r#"{"type": "ComplexItem", "complexItemType": "survey", "TransectStyleComplexItem": {"Items": []}}"#,
            "item 1: mission.items[0].TransectStyleComplexItem.Items: is empty: open the file",
        ),
        (
            r#"{"type": "SimpleItem", "command": 16, "frame": 3, "params": [0, 0, 0]}"#,
            "item 1: mission.items[0].params: give 7 numbers, or 4 and a coordinate of 3",
        ),
        (
            r#"{"type": "SimpleItem", "command": 16, "frame": 3}"#,
            "item 1: mission.items[0]: lacks \"params\"",
        ),
        (
            r#"{"type": "SimpleItem", "command": 5001, "frame": 3, "params": [0, 0, 0, 0, 1, 1, 1]}"#,
            "put it into geoFence or rallyPoints",
        ),
        (
            r#"{"type": "SimpleItem", "command": 177, "frame": 2, "params": [7, 1, 0, 0, 0, 0, 0]}"#,
            "item 1: parameter 1 (item): 7: no item has this doJumpId",
        ),
        (
            r#"{"type": "SimpleItem", "command": 16, "frame": 3, "params": [0, 0, 0, 0, "x", 1, 1]}"#,
            "mission.items[0].params[4]: give a number, or null",
        ),
    ];
    for (item, expected) in cases {
        let said = of_item(item);
        assert!(said.contains(expected), "{item}: {said}");
    }
    assert!(said(r#"{"fileType": "Plan", "version": 2}"#).contains("version: 2: only version 1"));
    assert!(said(r#"{"fileType": "Mission"}"#).contains("fileType: \"Mission\""));
    let before_3_2 = said(r#"{"version": "1.0", "plannedHomePosition": {}, "items": []}"#);
    assert!(before_3_2.contains("as files of QGroundControl before 3.2 do: open the file"));
    assert!(said("{").contains("is not JSON"));
    assert!(said("[]").contains("the file: give an object"));
    assert!(said("hello").contains("the first line has to be QGC WPL 110"));
    let deep = "[".repeat(100_000);
    assert!(said(&deep).contains("is not JSON"));
}

#[test]
fn a_text_file_has_no_place_for_an_obstacle() {
    let mut plan = Plan::default();
    plan.obstacles.push(Obstacle {
        centre: place(47.0, 8.0),
        radius_m: 10.0,
        top_m: 600.0,
    });
    let problems = write(&plan, Format::QgcWpl).unwrap_err();
    let said = problems[0].to_string();
    assert_eq!(
        said,
        "obstacles: QGC WPL 110 has no place for it: write a .plan, or remove it"
    );
}

#[test]
fn a_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.plan");
    let said = read_file(&file).unwrap_err().to_string();
    assert!(
        said.ends_with("a.plan: cannot be read: No such file or directory (os error 2)"),
        "{said}"
    );
    std::fs::write(&file, b"\xff\xfe").unwrap();
    let said = read_file(&file).unwrap_err().to_string();
    assert!(said.contains("a.plan: is not UTF-8"), "{said}");
    let mut long = String::from("{");
    while long.len() <= 4 << 20 {
        let _ = write!(long, "{:1000}", "");
    }
    std::fs::write(&file, long).unwrap();
    let said = read_file(&file).unwrap_err().to_string();
    assert!(said.contains("is larger than 4 MiB"), "{said}");
}
