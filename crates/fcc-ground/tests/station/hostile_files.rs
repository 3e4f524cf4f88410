//! Recordings, drafts, plans and files that somebody has placed or sent. Each test is an
//! attack by its name.

use std::fs::File;
use std::os::unix::fs::{FileExt as _, symlink};
use std::os::unix::net::UnixListener;
use std::time::{Duration, Instant};

use nix::sys::stat::Mode;
use nix::unistd::mkfifo;
use serde_json::{Value, json};

use crate::common::Ground;
use crate::flights::{fly, name};

const SOON: Duration = Duration::from_secs(10);
const PARTS: [&str; 5] = [
    "data?columns=tick",
    "events",
    "plan",
    "report",
    "download?format=csv",
];

#[test]
fn a_pipe_a_device_or_a_socket_among_the_recordings_stops_nothing() {
    let ground = Ground::new();
    let whole = name(&fly(&ground, 1_795_148_400, 2, false, true));
    let at = |name: &str| ground.path("recordings").join(name);
    mkfifo(&at("pipe.mcap"), Mode::S_IRWXU).unwrap();
    symlink("/dev/zero", at("zeros.mcap")).unwrap();
    let _socket = UnixListener::bind(at("socket.mcap")).unwrap();
    let begun = Instant::now();
    let list = ground.get("/api/flights");
    assert_eq!(list.status, 200);
    assert!(list.text().contains(&whole));
    for file in ["pipe.mcap", "zeros.mcap", "socket.mcap"] {
        for part in PARTS {
            let answer = ground.get(&format!("/api/flights/{file}/{part}"));
            assert_eq!(answer.status, 404, "{file} {part}");
        }
    }
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());
}

#[test]
fn a_recording_that_claims_terabytes_is_not_read() {
    let ground = Ground::new();
    let path = fly(&ground, 1_795_148_400, 2, false, true);
    let hole = ground.path("recordings/hole.mcap");
    std::fs::copy(path, &hole).unwrap();
    File::options()
        .write(true)
        .open(&hole)
        .unwrap()
        .set_len(1 << 42)
        .unwrap();
    let begun = Instant::now();
    assert_eq!(ground.get("/api/flights").status, 200);
    for part in PARTS.iter().take(4) {
        let status = ground.get(&format!("/api/flights/hole.mcap/{part}")).status;
        assert!(matches!(status, 200 | 400 | 500), "{part}: {status}");
    }
    assert!(
        begun.elapsed() < Duration::from_secs(30),
        "{:?}",
        begun.elapsed()
    );
}

#[test]
fn a_damaged_recording_costs_its_own_answer_alone() {
    let ground = Ground::new();
    let path = fly(&ground, 1_795_148_400, 20, false, true);
    let bytes = std::fs::read(&path).unwrap();
    for number in 0..60_u64 {
        let mut damaged = bytes.clone();
        // A fixed choice of places, some in the head and some in the summary at the end.
        for hit in 0..8 {
            let at = (number * 2_654_435_761 + hit * 40_503) as usize % bytes.len();
            let at = [at, at % 600, bytes.len() - 1 - at % 600][number as usize % 3];
            damaged[at] ^= 1 << (hit % 8);
        }
        if number % 5 == 0 {
            damaged.truncate(bytes.len() * number as usize / 60);
        }
        ground.write("recordings/damaged.mcap", &damaged);
        for part in PARTS {
            let answer = ground.get(&format!("/api/flights/damaged.mcap/{part}"));
            let text = answer.text();
            assert!(
                !text.contains("the station failed"),
                "{number} {part}: {text}"
            );
        }
    }
    let list = ground.get("/api/flights").json();
    assert_eq!(list.as_array().unwrap().len(), 2);
}

#[test]
fn a_name_with_quotes_and_lines_makes_no_line_of_the_head() {
    let ground = Ground::new();
    let path = fly(&ground, 1_795_148_400, 2, false, true);
    let hostile = "a\"; x=\r\nX-Evil: 1\r\n\r\n<script>.mcap";
    std::fs::copy(path, ground.path("recordings").join(hostile)).unwrap();
    let file = "a%22%3B%20x%3D%0D%0AX-Evil%3A%201%0D%0A%0D%0A%3Cscript%3E.mcap";
    for format in ["mcap", "csv", "gpx", "kml"] {
        let answer = ground.get(&format!("/api/flights/{file}/download?format={format}"));
        assert_eq!(answer.status, 200);
        assert_eq!(answer.header("x-evil"), None);
        let name = answer.header("content-disposition").unwrap();
        assert_eq!(
            name,
            format!("attachment; filename=\"axX-Evil1script.{format}\"")
        );
    }
}

#[test]
fn a_draft_that_was_damaged_or_placed_by_others_is_not_followed() {
    let ground = Ground::new();
    let at = |name: &str| ground.path("state/drafts").join(name);
    ground.write(
        "secret.json",
        br#"{"name":"s","revision":1,"changed_utc_s":0.0,"plan":{}}"#,
    );
    symlink(ground.path("secret.json"), at("link.json")).unwrap();
    symlink("/dev/zero", at("zeros.json")).unwrap();
    mkfifo(&at("pipe.json"), Mode::S_IRWXU).unwrap();
    std::fs::create_dir(at("folder.json")).unwrap();
    ground.write("state/drafts/torn.json", b"{\"name\":");
    let large = File::create(at("large.json")).unwrap();
    large.write_all_at(b"{", 1 << 33).unwrap();
    ground.write("state/drafts/deep.json", "[".repeat(1 << 20).as_bytes());
    let begun = Instant::now();
    assert_eq!(ground.get("/api/drafts").json(), json!([]));
    for name in ["link", "zeros", "pipe", "folder", "torn", "large", "deep"] {
        let status = ground.get(&format!("/api/drafts/{name}")).status;
        assert!(matches!(status, 404 | 500), "{name}: {status}");
        let edit = ground.change(&format!("PUT /api/drafts/{name}"), &json!({ "plan": {} }));
        assert!(matches!(edit.status, 404 | 500), "{name}: {}", edit.status);
    }
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());
    let saved = ground.change("PUT /api/drafts/good", &json!({ "plan": {} }));
    assert_eq!(saved.status, 200);
    assert!(
        std::fs::read_to_string(ground.path("secret.json"))
            .unwrap()
            .contains("\"s\"")
    );
}

#[test]
fn a_plan_of_loops_and_of_the_whole_earth_is_checked_in_time() {
    let ground = Ground::new();
    let point = |longitude_deg: f64| {
        json!({ "kind": "waypoint", "place": { "latitude_deg": 0.0, "longitude_deg": longitude_deg },
            "altitude": { "m": 100.0, "above": "sea-level" }, "radius_m": null })
    };
    let jump = |to: usize, times: Option<u32>| json!({ "kind": "jump", "to": to, "times": times });
    let loops: Vec<Value> = (0..300)
        .flat_map(|_| [point(1.0), point(2.0), jump(1, None)])
        .collect();
    let nested: Vec<Value> = (0..300)
        .flat_map(|number| [point(1.0), point(1.1), jump(2 * number + 1, Some(65_000))])
        .collect();
    let around: Vec<Value> = (0..999_u32)
        .map(|number| point(if number % 2 == 0 { -90.0 } else { 90.0 }))
        .collect();
    for (what, items) in [("loops", loops), ("nested", nested), ("around", around)] {
        let begun = Instant::now();
        let plan = json!({ "items": items });
        let body = json!({ "plan": plan }).to_string();
        let json = ["Content-Type: application/json"];
        let answer = ground.send("POST /api/plan/check", &json, &body);
        assert!(
            matches!(answer.status, 200 | 400),
            "{what}: {}",
            answer.text()
        );
        assert!(answer.body.len() < 8 << 20, "{what}: {}", answer.body.len());
        assert!(begun.elapsed() < SOON, "{what}: {:?}", begun.elapsed());
    }
}

#[test]
fn a_file_that_is_no_plan_is_not_imported() {
    let ground = Ground::new();
    let line = "1\t0\t3\t16\t0\t0\t0\t0\t45\t8\t100\t1\n";
    let texts = [
        (
            "many items",
            format!("QGC WPL 110\n{}", line.repeat(20_000)),
        ),
        ("deep", "{\"mission\":".repeat(100_000)),
        (
            "no numbers",
            "QGC WPL 110\n0 1 0 16 0 0 0 0 NaN inf 1e999 1\n".to_owned(),
        ),
        ("a recording", "\u{89}MCAP0\r\n".to_owned()),
        ("an archive", "PK\u{3}\u{4}".repeat(1_000)),
        (
            "entities",
            "<!DOCTYPE a [<!ENTITY b SYSTEM \"file:///etc/passwd\">]><kml>&b;</kml>".to_owned(),
        ),
        ("zeros", "\0".repeat(100_000)),
    ];
    for (what, text) in texts {
        let begun = Instant::now();
        let answer = ground.change(
            "POST /api/plan/import",
            &json!({ "text": text, "name": "a" }),
        );
        assert_eq!(answer.status, 400, "{what}");
        assert!(!answer.text().contains("root:"), "{what}");
        assert!(begun.elapsed() < SOON, "{what}: {:?}", begun.elapsed());
    }
}
