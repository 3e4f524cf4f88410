//! Requests that are not as a browser sends them. Each test is an attack by its name.

use std::io::Write as _;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::common::{Answer, Daemon, Ground, read, request, utc_ms, wait_for};

/// What only an answer to a request contains.
const ANSWERED: &str = "software";

fn raw(ground: &Ground, head: &str) -> Answer {
    let own = ground.address().to_string();
    ground.raw(head.replace("OWN", &own).as_bytes())
}

#[test]
fn heads_that_programs_read_differently_are_refused() {
    let ground = Ground::new();
    for head in [
        "GET /api/status HTTP/1.1\r\nHost: OWN\r\n folded\r\n\r\n",
        "GET /api/status HTTP/1.1\r\nHost : OWN\r\n\r\n",
        "GET /api/status HTTP/1.1\r\nHost: OWN\0\r\n\r\n",
        "GET /api/status HTTP/1.1\r\nHo\0st: OWN\r\n\r\n",
        "GET /api/status HTTP/1.1\r\n: OWN\r\n\r\n",
        "GET /api/status HTTP/1.1\rHost: OWN\r\n\r\n",
        "GET  /api/status HTTP/1.1\r\nHost: OWN\r\n\r\n",
        "GET /api/status\r\nHost: OWN\r\n\r\n",
        "GET /api/status HTTP/3.7\r\nHost: OWN\r\n\r\n",
        "GET /api/sta\ttus HTTP/1.1\r\nHost: OWN\r\n\r\n",
    ] {
        let answer = raw(&ground, head);
        assert!(
            matches!(answer.status, 0 | 400 | 403),
            "{head:?}: {}",
            answer.head
        );
        assert!(!answer.text().contains(ANSWERED), "{head:?}");
    }
}

#[test]
fn a_line_of_the_head_that_is_given_twice_is_refused() {
    let ground = Ground::new();
    let own = format!("Origin: http://{}", ground.address());
    let bearer = ground.bearer();
    for (first, second) in [
        (own.as_str(), "Origin: http://evil.example"),
        ("Origin: http://evil.example", own.as_str()),
        ("Sec-Fetch-Site: same-origin", "Sec-Fetch-Site: cross-site"),
        ("Content-Type: application/json", "Content-Type: text/plain"),
    ] {
        let lines = [first, second, bearer.as_str()];
        let answer = ground.send("PUT /api/drafts/a", &lines, r#"{"plan":{}}"#);
        assert!(
            matches!(answer.status, 400 | 403),
            "{second}: {}",
            answer.status
        );
    }
    assert_eq!(ground.get("/api/drafts").json(), json!([]));
}

const CHUNKED: &str = "POST /api/plan/check HTTP/1.1\r\nHost: OWN\r\nConnection: close\r\n\
    Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n";

#[test]
fn chunks_that_are_none_are_refused() {
    let ground = Ground::new();
    for body in [
        "FFFFFFFFFFFFFFFFF\r\n{}\r\n0\r\n\r\n",
        "-1\r\n{}\r\n0\r\n\r\n",
        "0x2\r\n{}\r\n0\r\n\r\n",
        "2\r\n{}XX0\r\n\r\n",
        "zz\r\n{}\r\n0\r\n\r\n",
        "\r\n{}\r\n0\r\n\r\n",
    ] {
        let answer = raw(&ground, &format!("{CHUNKED}{body}"));
        assert!(
            matches!(answer.status, 0 | 400 | 413),
            "{body:?}: {}",
            answer.head
        );
    }
    let long = format!("{CHUNKED}2;a={}\r\n{{}}\r\n0\r\n\r\n", "b".repeat(1 << 20));
    assert!(matches!(raw(&ground, &long).status, 0 | 400 | 413));
}

#[test]
fn a_body_in_chunks_without_an_end_is_cut_off() {
    let ground = Ground::new();
    let mut stream = ground.connect();
    let head = CHUNKED.replace("OWN", &ground.address().to_string());
    stream.write_all(head.as_bytes()).unwrap();
    let chunk = format!("10000\r\n{}\r\n", " ".repeat(0x1_0000));
    let mut sent = 0;
    while sent < 64 << 20 && stream.write_all(chunk.as_bytes()).is_ok() {
        sent += chunk.len();
    }
    assert!(sent < 32 << 20, "{sent} bytes were taken");
    assert!(matches!(read(&mut stream).status, 0 | 413));
    assert_eq!(ground.get("/api/status").status, 200);
}

#[test]
fn a_body_that_claims_gigabytes_is_refused_before_it_comes() {
    let ground = Ground::new();
    let begun = Instant::now();
    for length in ["9000000000", "18446744073709551615"] {
        let head = format!(
            "POST /api/plan/check HTTP/1.1\r\nHost: OWN\r\nContent-Type: application/json\r\n\
             Connection: close\r\nContent-Length: {length}\r\n\r\n{{"
        );
        let status = raw(&ground, &head).status;
        assert!(matches!(status, 0 | 400 | 413 | 431), "{length}: {status}");
    }
    for length in ["18446744073709551616", "-1", "+2", "0x2", "2 2", "2,2"] {
        let head = format!(
            "POST /api/plan/check HTTP/1.1\r\nHost: OWN\r\nContent-Type: application/json\r\n\
             Connection: close\r\nContent-Length: {length}\r\n\r\n{{}}"
        );
        assert!(matches!(raw(&ground, &head).status, 0 | 400), "{length}");
    }
    assert!(
        begun.elapsed() < Duration::from_secs(10),
        "{:?}",
        begun.elapsed()
    );
}

#[test]
fn a_packed_body_is_not_unpacked() {
    let ground = Ground::new();
    let bearer = ground.bearer();
    // 10 bytes of gzip's head, and what would be zeros without an end.
    let packed = "\u{1f}\u{8b}\u{8}\0\0\0\0\0\0\u{3}";
    for encoding in ["gzip", "deflate", "br", "zstd", "identity, gzip"] {
        let line = format!("Content-Encoding: {encoding}");
        let lines = [line.as_str(), &bearer, "Content-Type: application/json"];
        let answer = ground.send("PUT /api/drafts/a", &lines, packed);
        assert!(
            matches!(answer.status, 400 | 415),
            "{encoding}: {}",
            answer.status
        );
    }
    assert_eq!(ground.get("/api/drafts").json(), json!([]));
}

#[test]
fn another_protocol_is_not_spoken() {
    let ground = Ground::new();
    for head in [
        "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
        "GET http://OWN:80/ HTTP/1.1\r\nHost: OWN\r\n\r\n",
        "CONNECT evil.example:443 HTTP/1.1\r\nHost: OWN\r\n\r\n",
        "OPTIONS * HTTP/1.1\r\nHost: OWN\r\nConnection: close\r\n\r\n",
        "*1\r\n$4\r\nPING\r\n",
        "EHLO evil.example\r\n",
        "\u{0}\u{0}\u{0}\u{4}ping",
    ] {
        let answer = raw(&ground, head);
        assert!(
            matches!(answer.status, 0 | 400 | 403 | 405),
            "{head:?}: {}",
            answer.head
        );
    }
    let upgrade = "GET /api/status HTTP/1.1\r\nHost: OWN\r\nConnection: Upgrade, HTTP2-Settings, close\r\n\
        Upgrade: h2c\r\nHTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\n\r\n";
    assert_ne!(raw(&ground, upgrade).status, 101);
    // A WebSocket of another version, without a key, by another method, or where there is none.
    for (what, lines) in [
        (
            "GET /api/drafts",
            "Sec-WebSocket-Version: 8\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        ),
        ("GET /api/drafts", "Sec-WebSocket-Version: 13"),
        (
            "POST /api/drafts",
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        ),
        (
            "GET /api/status",
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        ),
    ] {
        let head = format!(
            "{what} HTTP/1.1\r\nHost: OWN\r\nUpgrade: websocket\r\nConnection: Upgrade, close\r\n{lines}\r\n\r\n"
        );
        assert_ne!(raw(&ground, &head).status, 101, "{what} {lines}");
    }
}

/// What an image, a link or a script of another site can ask for changes nothing.
#[test]
fn another_method_in_a_header_or_an_address_changes_nothing() {
    let ground = Ground::new();
    let daemon = Daemon::start("method");
    wait_for(&ground, &daemon);
    ground.write("recordings/a.mcap", b"no recording");
    let saved = ground.change("PUT /api/drafts/a", &json!({ "plan": {} }));
    assert_eq!(saved.status, 200);
    let bearer = ground.bearer();
    let live = format!("/api/live/{}", daemon.instance);
    for path in [
        "/api/flights/a.mcap?_method=DELETE".to_owned(),
        "/api/flights/a.mcap?method=DELETE".to_owned(),
        "/api/drafts/a?_method=DELETE".to_owned(),
        format!("{live}/command?number=1&deadline_ms_utc=99999999999999&command=engage"),
        format!("{live}/plan?draft=a&revision=1&number=2&deadline_ms_utc=99999999999999"),
    ] {
        for method in ["GET", "HEAD"] {
            let lines = [
                bearer.as_str(),
                "X-HTTP-Method-Override: DELETE",
                "X-HTTP-Method: DELETE",
                "X-Method-Override: POST",
            ];
            ground.send(&format!("{method} {path}"), &lines, "");
        }
    }
    sleep(Duration::from_millis(300));
    assert!(ground.path("recordings/a.mcap").exists());
    assert_eq!(
        ground.get("/api/drafts/a").json()["revision"],
        saved.json()["revision"]
    );
    assert!(daemon.commands.try_recv().is_err());
}

#[test]
fn a_part_of_a_command_that_is_given_twice_is_refused() {
    let ground = Ground::new();
    let daemon = Daemon::start("twice");
    wait_for(&ground, &daemon);
    let what = format!("POST /api/live/{}/command", daemon.instance);
    let bearer = ground.bearer();
    let lines = [bearer.as_str(), "Content-Type: application/json"];
    let until = utc_ms() + 10_000;
    for body in [
        format!(r#"{{"number":1,"number":2,"deadline_ms_utc":{until},"command":"engage"}}"#),
        format!(
            r#"{{"number":3,"deadline_ms_utc":1,"deadline_ms_utc":{until},"command":"engage"}}"#
        ),
        format!(r#"{{"number":4,"deadline_ms_utc":{until},"command":"pause","command":"engage"}}"#),
        format!(r#"{{"number":5,"deadline_ms_utc":{until},"command":"engage"}}{{}}"#),
        format!(
            r#"{{"number":6,"deadline_ms_utc":{until},"command":{{"set":{{"altitude_m":1e999}}}}}}"#
        ),
        format!(
            r#"{{"number":7,"deadline_ms_utc":{until},"command":{{"set":{{"altitude_m":null}}}}}}"#
        ),
        format!("\u{feff}{{\"number\":8,\"deadline_ms_utc\":{until},\"command\":\"engage\"}}"),
    ] {
        let answer = ground.send(&what, &lines, &body);
        assert_eq!(answer.status, 400, "{body}: {}", answer.text());
    }
    sleep(Duration::from_millis(300));
    assert!(daemon.commands.try_recv().is_err());
}

#[test]
fn a_set_point_that_is_none_stops_nothing() {
    let ground = Ground::new();
    let daemon = Daemon::start("set-points");
    wait_for(&ground, &daemon);
    let what = format!("POST /api/live/{}/command", daemon.instance);
    let many: serde_json::Map<String, Value> = (0..10_000)
        .map(|number| (format!("a{number}"), json!(1.0)))
        .collect();
    let long = json!({ "a".repeat(100_000): 1.0 });
    for (number, set) in [json!(many), long, json!({ "\0": 1.0 }), json!({ "": 1.0 })]
        .iter()
        .enumerate()
    {
        let body = json!({ "number": number, "deadline_ms_utc": utc_ms() + 10_000,
            "command": { "set": set } });
        let answer = ground.change(&what, &body);
        assert!(
            !answer.text().contains("the station failed"),
            "{number}: {}",
            answer.text()
        );
        assert_ne!(answer.status, 0, "{number}");
    }
    let body = json!({ "number": 9, "deadline_ms_utc": utc_ms() + 10_000, "command": "pause" });
    assert_eq!(ground.change(&what, &body).status, 200);
}

#[test]
fn the_name_of_a_daemon_leads_nowhere_else() {
    let ground = Ground::new();
    let daemon = Daemon::start("names");
    wait_for(&ground, &daemon);
    let body = json!({ "number": 1, "deadline_ms_utc": utc_ms() + 10_000, "command": "engage",
        "draft": "a", "revision": 1 });
    let long = "a".repeat(300);
    for name in [
        format!("..%2F{}", daemon.instance),
        format!("{}%00", daemon.instance),
        format!("{}%2F..%2F{}", daemon.instance, daemon.instance),
        format!("%20{}", daemon.instance),
        "..".to_owned(),
        "%2Fetc".to_owned(),
        "*".to_owned(),
        "%F0%9F%92%A9".to_owned(),
        long,
    ] {
        for part in ["command", "plan"] {
            let answer = ground.change(&format!("POST /api/live/{name}/{part}"), &body);
            assert!(
                matches!(answer.status, 400 | 404 | 405),
                "{name}: {}",
                answer.status
            );
        }
        let answer = ground.get(&format!("/api/live/{name}/columns"));
        assert!(
            matches!(answer.status, 400 | 404),
            "{name}: {}",
            answer.status
        );
    }
    sleep(Duration::from_millis(300));
    assert!(daemon.commands.try_recv().is_err());
}

#[test]
fn an_upload_that_is_replayed_late_or_of_an_older_draft_changes_nothing() {
    let ground = Ground::new();
    let daemon = Daemon::start("upload");
    wait_for(&ground, &daemon);
    let save = |based_on: u64| {
        let point = json!({ "kind": "waypoint", "altitude": { "m": 900.0, "above": "sea-level" },
            "place": { "latitude_deg": 45.0 + based_on as f64 * 1e-14, "longitude_deg": 8.0 }, "radius_m": null });
        let body = json!({ "based_on": based_on, "plan": { "items": [point] } });
        let answer = ground.change("PUT /api/drafts/a", &body);
        answer.json()["revision"].as_u64().unwrap()
    };
    let old = save(0);
    let new = save(old);
    let upload = |number: u64, revision: u64, deadline_ms_utc: u64| {
        let body = json!({ "number": number, "deadline_ms_utc": deadline_ms_utc, "draft": "a",
            "revision": revision });
        let what = format!("POST /api/live/{}/plan", daemon.instance);
        let answer = ground.change(&what, &body);
        (answer.status, answer.text())
    };
    let (status, why) = upload(1, old, utc_ms() + 10_000);
    assert!(status == 409 && why.contains("changed meanwhile"), "{why}");
    let (status, why) = upload(2, new, utc_ms() - 1);
    assert!(status == 409 && why.contains("deadline"), "{why}");
    sleep(Duration::from_millis(300));
    assert!(daemon.commands.try_recv().is_err());
    // This daemon accepts it, and never shows it.
    let (_, why) = upload(3, new, utc_ms() + 10_000);
    assert!(
        daemon.commands.recv_timeout(Duration::from_secs(5)).is_ok(),
        "{why}"
    );
    let (status, why) = upload(3, new, utc_ms() + 10_000);
    assert!(status == 409 && why.contains("used before"), "{why}");
    assert!(daemon.commands.try_recv().is_err());
}

#[test]
fn a_link_that_was_replaced_permits_nothing() {
    let ground = Ground::new();
    let old = ground.bearer();
    let ground = Ground::again_with(ground, &["--new-token"]);
    let json = "Content-Type: application/json";
    let body = r#"{"plan":{}}"#;
    assert_eq!(
        ground.send("PUT /api/drafts/a", &[&old, json], body).status,
        401
    );
    let new = ground.bearer();
    assert_eq!(
        ground.send("PUT /api/drafts/a", &[&new, json], body).status,
        200
    );
}

#[test]
fn no_answer_of_the_interface_stays_in_a_cache_or_a_cookie() {
    let ground = Ground::new();
    for path in [
        "/api/status",
        "/api/drafts",
        "/api/flights",
        "/api/map",
        "/api/nothing",
    ] {
        let answer = ground.get(path);
        assert_eq!(answer.header("cache-control"), Some("no-store"), "{path}");
        assert_eq!(answer.header("set-cookie"), None, "{path}");
    }
    let host = format!("Host: {}", ground.address());
    let page = ground.raw(request("GET /", &[&host], "").as_bytes());
    assert_eq!(page.header("cache-control"), Some("no-cache"));
}

#[test]
fn a_calibration_is_refused_beside_its_daemon_and_of_what_is_not_known() {
    let daemon = Daemon::start("calibrated");
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("fccd.toml");
    let named = |name: &str| format!("[built-in]\n[telemetry]\ninstance = \"{name}\"\n");
    std::fs::write(&config, named(&daemon.instance.to_string())).unwrap();
    let ground = Ground::with(&["--fccd", "/bin/false", "--config", config.to_str().unwrap()]);
    wait_for(&ground, &daemon);
    let begin = |instance: &str, kind: &str| {
        let body = json!({ "instance": instance, "kind": kind });
        ground.change("POST /api/calibration", &body).status
    };
    assert_eq!(begin(&daemon.instance.to_string(), "airspeed"), 409);
    assert_eq!(begin("another", "airspeed"), 409);
    let lines = ["Content-Type: application/json"];
    let answer = ground.send("POST /api/calibration", &lines, "{}");
    assert_eq!(answer.status, 401);
    assert_eq!(
        ground.change("DELETE /api/calibration", &json!({})).status,
        404
    );
    drop(daemon);
    // An option is no kind.
    std::fs::write(&config, named("at-rest")).unwrap();
    let ground = Ground::with(&["--fccd", "/bin/false", "--config", config.to_str().unwrap()]);
    let begin = |kind: &str| {
        let body = json!({ "instance": "at-rest", "kind": kind });
        ground.change("POST /api/calibration", &body).status
    };
    assert_eq!(begin("--help"), 400);
    assert_eq!(begin("airspeed"), 200);
    let begun = Instant::now();
    while ground.get("/api/calibration").json()["exit_code"] != 1 {
        assert!(
            begun.elapsed() < Duration::from_secs(30),
            "it has not ended"
        );
        sleep(Duration::from_millis(50));
    }
}

#[test]
fn what_is_behind_a_question_mark_and_is_none_is_refused_as_json() {
    let ground = Ground::new();
    for path in [
        "/api/terrain?south=1",
        "/api/flights/a.mcap/data?points=abc",
        "/api/flights/a.mcap/download?format=xyz",
    ] {
        let answer = ground.get(path);
        assert_eq!(answer.status, 400, "{path}");
        assert!(answer.json()["error"].is_string(), "{path}");
    }
}
