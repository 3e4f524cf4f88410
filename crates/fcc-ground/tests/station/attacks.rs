//! What hostile sites, networks and files try. Each test is an attack by its name.

use std::io::Write as _;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::common::{Daemon, Ground, read, request, utc_ms, wait_for};

pub(crate) const UPGRADE: [&str; 4] = [
    "Upgrade: websocket",
    "Connection: Upgrade",
    "Sec-WebSocket-Version: 13",
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
];

#[test]
fn a_name_that_was_rebound_to_the_station_gets_nothing() {
    let ground = Ground::new();
    let port = ground.address().port();
    for host in [
        "evil.example".to_owned(),
        format!("evil.example:{port}"),
        format!("127.0.0.1.evil.example:{port}"),
        format!("localhost.:{port}"),
        "127.0.0.1".to_owned(),
        "localhost".to_owned(),
        format!("127.0.0.2:{port}"),
        format!("127.0.0.1:{}", port - 1),
        format!("user@127.0.0.1:{port}"),
        format!("127.0.0.1:{port},evil.example"),
        String::new(),
    ] {
        for path in ["/", "/api/status", "/api/drafts", "/api/flights"] {
            let line = format!("Host: {host}");
            let answer = ground.raw(request(&format!("GET {path}"), &[&line], "").as_bytes());
            assert_eq!(answer.status, 403, "{host:?} {path}");
            assert!(!answer.text().contains("software"), "{host:?} {path}");
        }
    }
    assert_eq!(ground.get("/api/status").status, 200);
}

#[test]
fn a_request_without_a_host_or_with_two_gets_nothing() {
    let ground = Ground::new();
    let own = format!("Host: {}", ground.address());
    let without = ground.raw(b"GET /api/status HTTP/1.1\r\nConnection: close\r\n\r\n");
    assert!(matches!(without.status, 400 | 403), "{}", without.head);
    for lines in [
        [own.as_str(), "Host: evil.example"],
        ["Host: evil.example", own.as_str()],
    ] {
        let answer = ground.raw(request("GET /api/status", &lines, "").as_bytes());
        assert!(matches!(answer.status, 400 | 403), "{}", answer.head);
    }
    let old = ground.raw(b"GET /api/status HTTP/1.0\r\n\r\n");
    assert!(matches!(old.status, 400 | 403), "{}", old.head);
}

#[test]
fn an_absolute_address_of_another_site_gets_nothing() {
    let ground = Ground::new();
    let own = format!("Host: {}", ground.address());
    let answer = ground.raw(request("GET http://evil.example/api/status", &[&own], "").as_bytes());
    assert_eq!(answer.status, 403);
    let what = format!("GET http://{}/api/status", ground.address());
    let answer = ground.raw(request(&what, &["Host: evil.example"], "").as_bytes());
    assert_eq!(answer.status, 403);
}

#[test]
fn a_page_of_another_site_reads_and_changes_nothing() {
    let ground = Ground::new();
    let own = ground.address();
    let bearer = ground.bearer();
    for origin in [
        "http://evil.example".to_owned(),
        "null".to_owned(),
        format!("https://{own}"),
        format!("http://{own}.evil.example"),
        format!("http://127.0.0.1:{}", own.port() - 1),
        format!("http://localhost:{}", own.port()),
        format!("http://{own}/"),
        format!("ftp://{own}"),
        "http://".to_owned(),
    ] {
        let line = format!("Origin: {origin}");
        let answer = ground.send("GET /api/status", &[&line], "");
        assert_eq!(answer.status, 403, "{origin}");
        // Even with the token.
        let lines = [
            line.as_str(),
            bearer.as_str(),
            "Content-Type: application/json",
        ];
        let answer = ground.send("PUT /api/drafts/a", &lines, r#"{"plan":{}}"#);
        assert_eq!(answer.status, 403, "{origin}");
        let lines: Vec<&str> = UPGRADE.into_iter().chain([line.as_str()]).collect();
        let answer = ground.send("GET /api/drafts", &lines, "");
        assert_eq!(answer.status, 403, "{origin}");
    }
    assert_eq!(ground.get("/api/drafts").json(), json!([]));
    let line = format!("Origin: http://{own}");
    assert_eq!(ground.send("GET /api/status", &[&line], "").status, 200);
}

#[test]
fn a_websocket_of_another_site_is_refused_and_one_of_this_page_is_not() {
    let ground = Ground::new();
    let daemon = Daemon::start("cross-site");
    wait_for(&ground, &daemon);
    let what = format!("GET /api/live/{}", daemon.instance);
    let status = |origin: &str| {
        let origin = format!("Origin: {origin}");
        let host = format!("Host: {}", ground.address());
        let mut stream = ground.connect();
        stream
            .set_read_timeout(Some(Duration::from_millis(500)))
            .unwrap();
        let lines: Vec<&str> = UPGRADE
            .into_iter()
            .chain([origin.as_str(), host.as_str()])
            .collect();
        let head = format!("{what} HTTP/1.1\r\n{}\r\n\r\n", lines.join("\r\n"));
        stream.write_all(head.as_bytes()).unwrap();
        read(&mut stream).status
    };
    assert_eq!(status("http://evil.example"), 403);
    assert_eq!(status("null"), 403);
    assert_eq!(status(&format!("http://{}", ground.address())), 101);
}

#[test]
fn what_a_browser_says_another_site_asked_for_is_refused() {
    let ground = Ground::new();
    for site in ["cross-site", "same-site", "anything"] {
        let line = format!("Sec-Fetch-Site: {site}");
        assert_eq!(
            ground.send("GET /api/flights", &[&line], "").status,
            403,
            "{site}"
        );
        assert_eq!(
            ground.send("GET /map.pmtiles", &[&line], "").status,
            403,
            "{site}"
        );
        // A link to the page may be followed.
        assert_eq!(ground.send("GET /", &[&line], "").status, 200, "{site}");
    }
    assert_eq!(
        ground
            .send("GET /api/flights", &["Sec-Fetch-Site: same-origin"], "")
            .status,
        200
    );
}

#[test]
fn no_other_site_is_permitted_by_cors() {
    let ground = Ground::new();
    let preflight = [
        "Origin: http://evil.example",
        "Access-Control-Request-Method: PUT",
        "Access-Control-Request-Headers: authorization,content-type",
        "Access-Control-Request-Private-Network: true",
    ];
    let mut answers = vec![ground.send("OPTIONS /api/drafts/a", &preflight, "")];
    answers.push(ground.send("OPTIONS /api/drafts/a", &[], ""));
    answers.push(ground.get("/api/status"));
    answers.push(ground.get("/"));
    for answer in &answers {
        let head = answer.head.to_ascii_lowercase();
        assert!(!head.contains("access-control-"), "{head}");
    }
    assert!(answers[0].status == 403 && answers[1].status == 405);
}

#[test]
fn a_form_of_another_site_sends_no_command() {
    let ground = Ground::new();
    let daemon = Daemon::start("form");
    wait_for(&ground, &daemon);
    let bearer = ground.bearer();
    let what = format!("POST /api/live/{}/command", daemon.instance);
    let body = json!({ "number": 1, "deadline_ms_utc": utc_ms() + 5_000, "command": "engage" });
    for kind in [
        "text/plain",
        "application/x-www-form-urlencoded",
        "multipart/form-data; boundary=a",
        "application/json; charset=utf-8",
        "",
    ] {
        let kind = format!("Content-Type: {kind}");
        // A browser sends forms to anywhere, but never with this token.
        let answer = ground.send(&what, &[&kind], &body.to_string());
        assert_eq!(answer.status, 401, "{kind}");
        let answer = ground.send(&what, &[&kind, &bearer], &body.to_string());
        assert_eq!(answer.status, 415, "{kind}");
    }
    sleep(Duration::from_millis(300));
    assert!(daemon.commands.try_recv().is_err());
}

#[test]
fn a_viewer_without_the_token_changes_nothing() {
    let ground = Ground::new();
    let daemon = Daemon::start("viewer");
    wait_for(&ground, &daemon);
    ground.write("recordings/a.mcap", b"no recording");
    let saved = ground.change("PUT /api/drafts/a", &json!({ "plan": {} }));
    assert_eq!(saved.status, 200, "{}", saved.text());
    let live = format!("/api/live/{}", daemon.instance);
    let order = json!({ "number": 1, "deadline_ms_utc": utc_ms() + 5_000, "command": "disengage",
        "draft": "a", "revision": saved.json()["revision"] });
    let token = ground.running.token.as_str();
    let wrong = [
        String::new(),
        "Authorization: Bearer ".to_owned(),
        "Authorization: Bearer 00000000000000000000000000000000".to_owned(),
        format!("Authorization: Bearer {}", &token[..31]),
        format!("Authorization: Bearer {token}0"),
        format!("Authorization: bearer {token}"),
        format!("Authorization: Basic {token}"),
        format!("Authorization: Bearer {token}\r\nAuthorization: Bearer {token}"),
        format!("Cookie: token={token}"),
    ];
    for line in &wrong {
        let lines: Vec<&str> = [line.as_str(), "Content-Type: application/json"]
            .into_iter()
            .filter(|line| !line.is_empty())
            .collect();
        for what in [
            format!("POST {live}/command"),
            format!("POST {live}/plan"),
            "PUT /api/drafts/b".to_owned(),
            "PUT /api/drafts/a".to_owned(),
            "DELETE /api/drafts/a".to_owned(),
            "DELETE /api/flights/a.mcap".to_owned(),
            "POST /api/anything".to_owned(),
        ] {
            let answer = ground.send(&what, &lines, &order.to_string());
            assert_eq!(answer.status, 401, "{what} {line}");
        }
        let status = ground.send("GET /api/status", &lines, "").json();
        assert_eq!(status["writable"], false, "{line}");
    }
    // In the address it is no token either: addresses are in logs and histories.
    let answer = ground.send(&format!("DELETE /api/drafts/a?token={token}"), &[], "");
    assert_eq!(answer.status, 401);
    assert_eq!(
        ground.get("/api/drafts").json().as_array().unwrap().len(),
        1
    );
    assert!(ground.path("recordings/a.mcap").exists());
    assert!(daemon.commands.try_recv().is_err());
    let bearer = ground.bearer();
    assert_eq!(
        ground.send("GET /api/status", &[&bearer], "").json()["writable"],
        true
    );
}

#[test]
fn no_answer_contains_the_token() {
    let ground = Ground::new();
    let token = ground.running.token.as_str();
    let bearer = ground.bearer();
    for path in [
        "/",
        "/token",
        "/api/token",
        "/api/status",
        "/api/drafts",
        "/api/drafts/token",
        "/api/flights/token.mcap/data",
        "/../token",
        "/state/token",
    ] {
        let answer = ground.send(&format!("GET {path}"), &[&bearer], "");
        assert!(
            !answer.text().contains(token) && !answer.head.contains(token),
            "{path}"
        );
    }
}

#[test]
fn a_command_that_is_replayed_or_late_is_not_carried_out() {
    let ground = Ground::new();
    let daemon = Daemon::start("replay");
    wait_for(&ground, &daemon);
    let what = format!("POST /api/live/{}/command", daemon.instance);
    let command = |number: u64, deadline_ms_utc: u64| {
        let body =
            json!({ "number": number, "deadline_ms_utc": deadline_ms_utc, "command": "pause" });
        ground.change(&what, &body)
    };
    let now_ms = utc_ms();
    let first = command(7, now_ms + 5_000);
    assert_eq!(first.status, 200, "{}", first.text());
    assert!(first.json()["carried_out"].as_u64().unwrap() > 0);
    assert_eq!(command(7, now_ms + 5_000).status, 409, "replayed");
    assert_eq!(
        command(7, utc_ms() + 9_000).status,
        409,
        "replayed with another deadline"
    );
    assert_eq!(command(8, now_ms - 1).status, 409, "late");
    assert_eq!(command(9, 0).status, 409, "never in time");
    assert_eq!(command(10, u64::MAX).status, 409, "for ever in time");
    assert_eq!(
        command(11, utc_ms() + 3_600_000).status,
        409,
        "in time for an hour"
    );
    sleep(Duration::from_millis(300));
    let sent: Vec<_> = daemon.commands.try_iter().collect();
    assert_eq!(sent.len(), 1);
    assert_eq!(sent[0].sender, "ground station, page at 127.0.0.1");
}

#[test]
fn a_command_that_is_no_command_is_refused() {
    let ground = Ground::new();
    let daemon = Daemon::start("no-command");
    wait_for(&ground, &daemon);
    let what = format!("POST /api/live/{}/command", daemon.instance);
    let deadline_ms_utc = utc_ms() + 10_000;
    for (number, command) in [
        json!("stop"),
        json!("Engage"),
        json!(null),
        json!({ "set": {} , "engage": null }),
        json!({ "go_to": { "latitude_deg": 1.0 } }),
        json!({ "replace_plan": { "file": "/etc/passwd", "item": 1 } }),
        json!({ "item": -1 }),
        json!({ "item": 70_000 }),
    ]
    .into_iter()
    .enumerate()
    {
        let body =
            json!({ "number": number, "deadline_ms_utc": deadline_ms_utc, "command": command });
        let answer = ground.change(&what, &body);
        assert_eq!(answer.status, 400, "{command}: {}", answer.text());
    }
    for body in [
        "",
        "{",
        "[]",
        r#"{"number":-1,"deadline_ms_utc":1,"command":"engage"}"#,
        r#"{"number":1e99,"deadline_ms_utc":1,"command":"engage"}"#,
    ] {
        let bearer = ground.bearer();
        let lines = [bearer.as_str(), "Content-Type: application/json"];
        assert_eq!(ground.send(&what, &lines, body).status, 400, "{body}");
    }
    assert!(daemon.commands.try_recv().is_err());
}

#[test]
fn a_path_leads_to_no_other_file() {
    let ground = Ground::new();
    ground.write("recordings/whole.mcap", b"no recording");
    ground.write("secret.mcap", b"classified");
    ground.write("recordings/sub/inner.mcap", b"classified");
    std::os::unix::fs::symlink(
        ground.path("secret.mcap"),
        ground.path("recordings/link.mcap"),
    )
    .unwrap();
    std::fs::create_dir(ground.path("recordings/folder.mcap")).unwrap();
    for file in [
        "..%2Fsecret.mcap",
        "%2e%2e%2fsecret.mcap",
        "%2e%2e/secret.mcap",
        "../secret.mcap",
        "....//secret.mcap",
        "..%5Csecret.mcap",
        "..%252Fsecret.mcap",
        "sub%2Finner.mcap",
        "%2Fetc%2Fpasswd",
        "%2Fetc%2Fpasswd%00.mcap",
        "whole.mcap%00.txt",
        "link.mcap",
        "folder.mcap",
        ".mcap",
        ".order",
        "..",
        "",
    ] {
        for part in [
            "data",
            "events",
            "plan",
            "report",
            "download?format=mcap",
            "compare/whole.mcap",
        ] {
            let answer = ground.get(&format!("/api/flights/{file}/{part}"));
            assert!(
                matches!(answer.status, 400 | 404 | 405),
                "{file} {part}: {}",
                answer.status
            );
            assert!(!answer.text().contains("classified"), "{file} {part}");
        }
        let answer = ground.change(&format!("DELETE /api/flights/{file}"), &Value::Null);
        assert!(
            matches!(answer.status, 400 | 404 | 405),
            "{file}: {}",
            answer.status
        );
    }
    for path in [
        "/../secret.mcap",
        "/assets/../../../Cargo.toml",
        "/%2e%2e/%2e%2e/Cargo.toml",
        "//etc/passwd",
        "/..%2f..%2fCargo.toml",
        "/C:/",
    ] {
        let answer = ground.get(path);
        assert!(
            matches!(answer.status, 400 | 404),
            "{path}: {}",
            answer.status
        );
    }
    for name in [
        "..%2Fa",
        "%2e%2e",
        ".a",
        "a%2Fb",
        "a%00",
        "%20",
        "a%0Ab",
        "%C3%A4",
        &"a".repeat(65),
    ] {
        let answer = ground.change(&format!("PUT /api/drafts/{name}"), &json!({ "plan": {} }));
        assert!(
            matches!(answer.status, 400 | 404),
            "{name}: {}",
            answer.status
        );
        let answer = ground.get(&format!("/api/drafts/{name}"));
        assert!(
            matches!(answer.status, 400 | 404),
            "{name}: {}",
            answer.status
        );
    }
    assert!(ground.path("secret.mcap").exists() && ground.path("recordings/link.mcap").exists());
    assert!(ground.path("recordings/folder.mcap").exists());
}

#[test]
fn markup_in_texts_is_sent_as_data() {
    let ground = Ground::new();
    let daemon = Daemon::start("markup");
    wait_for(&ground, &daemon);
    let markup = "%3Cscript%3Ealert(1)%3C%2Fscript%3E";
    for path in [
        "/api/status".to_owned(),
        format!("/api/drafts/{markup}"),
        format!("/api/live/{markup}/columns"),
        format!("/api/flights/{markup}.mcap/data"),
        format!("/{markup}"),
        format!("/api/{markup}"),
        format!("/api/terrain?south={markup}"),
    ] {
        let answer = ground.get(&path);
        let kind = answer.header("content-type").unwrap_or_default();
        assert!(
            kind.starts_with("application/json") || kind.starts_with("text/plain"),
            "{path}: {kind}"
        );
        assert_eq!(
            answer.header("x-content-type-options"),
            Some("nosniff"),
            "{path}"
        );
    }
    assert!(ground.get("/api/status").text().contains("<b>test</b>"));
}

#[test]
fn every_answer_forbids_frames_sniffing_and_foreign_content() {
    let ground = Ground::new();
    for (what, lines) in [
        ("GET /", vec![]),
        ("GET /nothing", vec![]),
        ("GET /api/status", vec![]),
        ("GET /api/nothing", vec![]),
        ("POST /api/drafts/a", vec![]),
        ("GET /api/status", vec!["Origin: http://evil.example"]),
        ("TRACE /", vec![]),
    ] {
        let answer = ground.send(what, &lines, "");
        let policy = answer.header("content-security-policy").unwrap_or_default();
        for part in [
            "default-src 'none'",
            "script-src 'self'",
            "frame-ancestors 'none'",
            "base-uri 'none'",
            "form-action 'none'",
        ] {
            assert!(policy.contains(part), "{what}: {policy}");
        }
        assert!(
            !policy.contains("unsafe-eval") && !policy.contains("script-src 'self' 'unsafe"),
            "{policy}"
        );
        assert_eq!(answer.header("x-frame-options"), Some("DENY"), "{what}");
        assert_eq!(
            answer.header("x-content-type-options"),
            Some("nosniff"),
            "{what}"
        );
        assert_eq!(
            answer.header("referrer-policy"),
            Some("no-referrer"),
            "{what}"
        );
        assert_eq!(
            answer.header("cross-origin-resource-policy"),
            Some("same-origin"),
            "{what}"
        );
    }
}

#[test]
fn what_is_too_large_is_refused() {
    let ground = Ground::new();
    let large = format!(r#"{{"plan":{{"items":[{}]}}}}"#, " ".repeat(9 << 20));
    let bearer = ground.bearer();
    let lines = [bearer.as_str(), "Content-Type: application/json"];
    let answer = ground.send("PUT /api/drafts/a", &lines, &large);
    assert!(matches!(answer.status, 413 | 0), "{}", answer.status);
    let answer = ground.send(
        "POST /api/plan/check",
        &["Content-Type: application/json"],
        &large[..2 << 20],
    );
    assert!(matches!(answer.status, 413 | 0), "{}", answer.status);
    let long = format!("X-Long: {}", "a".repeat(100_000));
    assert!(matches!(
        ground.send("GET /", &[&long], "").status,
        400 | 431 | 0
    ));
    let many: Vec<String> = (0..200).map(|n| format!("X-{n}: a")).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    assert!(matches!(
        ground.send("GET /", &many, "").status,
        400 | 431 | 0
    ));
    let address = format!("GET /{}", "a".repeat(100_000));
    assert!(matches!(
        ground.send(&address, &[], "").status,
        400 | 414 | 431 | 0
    ));
    assert_eq!(ground.get("/api/drafts").json(), json!([]));
}

#[test]
fn a_plan_that_is_too_large_or_too_deep_or_no_plan_is_refused() {
    let ground = Ground::new();
    let point = json!({ "kind": "waypoint", "place": { "latitude_deg": 1.0, "longitude_deg": 1.0 },
        "altitude": { "m": 1.0, "above": "home" } });
    let save = |plan: Value| {
        ground
            .change("PUT /api/drafts/a", &json!({ "plan": plan }))
            .status
    };
    assert_eq!(save(json!({ "items": vec![point.clone(); 1_001] })), 400);
    assert_eq!(save(json!({ "items": [{ "kind": "bomb" }] })), 400);
    assert_eq!(save(json!({ "script": "<script>" })), 400);
    assert_eq!(save(json!({ "cruise_mps": "fast" })), 400);
    let bearer = ground.bearer();
    let lines = [bearer.as_str(), "Content-Type: application/json"];
    let deep = format!(
        r#"{{"plan":{}{}}}"#,
        "[".repeat(100_000),
        "]".repeat(100_000)
    );
    assert_eq!(ground.send("PUT /api/drafts/a", &lines, &deep).status, 400);
    assert_eq!(
        ground
            .send(
                "PUT /api/drafts/a",
                &lines,
                r#"{"plan":{"cruise_mps":1e999}}"#
            )
            .status,
        400
    );
    assert_eq!(ground.get("/api/drafts").json(), json!([]));
    assert_eq!(save(json!({ "items": [point] })), 200);
}

#[test]
fn ambiguous_lengths_and_unknown_methods_are_refused() {
    let ground = Ground::new();
    let own = format!("Host: {}", ground.address());
    let smuggled = format!(
        "POST /api/plan/check HTTP/1.1\r\n{own}\r\nContent-Type: application/json\r\n\
         Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\nGET /api/status HTTP/1.1\r\n{own}\r\n\r\n"
    );
    let answer = ground.raw(smuggled.as_bytes());
    assert!(matches!(answer.status, 400 | 0), "{}", answer.head);
    assert!(!answer.text().contains("software"));
    let twice = format!(
        "POST /api/plan/check HTTP/1.1\r\n{own}\r\nContent-Length: 4\r\nContent-Length: 5\r\n\r\nabcde"
    );
    assert!(matches!(ground.raw(twice.as_bytes()).status, 400 | 0));
    for method in ["TRACE", "PATCH", "CONNECT", "PROPFIND", "get"] {
        let status = ground
            .send(&format!("{method} /api/status"), &[], "")
            .status;
        assert!(matches!(status, 400 | 403 | 405), "{method}: {status}");
    }
    assert!(matches!(
        ground
            .raw(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03")
            .status,
        400 | 0
    ));
}

#[test]
fn heads_that_never_end_and_connections_that_say_nothing_are_closed() {
    let ground = Ground::new();
    let begun = Instant::now();
    let mut silent: Vec<_> = (0..20).map(|_| ground.connect()).collect();
    let mut slow: Vec<_> = (0..20).map(|_| ground.connect()).collect();
    for stream in &mut slow {
        stream.write_all(b"GET / HTTP/1.1\r\nX-").unwrap();
    }
    for _ in 0..12 {
        for stream in &mut slow {
            let _ = stream.write_all(b"a");
        }
        // Others are served meanwhile.
        assert_eq!(ground.get("/api/status").status, 200);
        sleep(Duration::from_secs(1));
    }
    for stream in silent.iter_mut().chain(&mut slow) {
        assert!(matches!(read(stream).status, 0 | 408));
    }
    assert!(
        begun.elapsed() < Duration::from_secs(25),
        "{:?}",
        begun.elapsed()
    );
}

#[test]
fn a_body_that_never_ends_is_given_up() {
    let ground = Ground::new();
    let bearer = ground.bearer();
    let head = format!(
        "PUT /api/drafts/a HTTP/1.1\r\nHost: {}\r\n{bearer}\r\nContent-Type: application/json\r\n\
         Content-Length: 1000\r\n\r\n",
        ground.address()
    );
    let mut stream = ground.connect();
    stream.write_all(head.as_bytes()).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_millis(500)))
        .unwrap();
    let begun = Instant::now();
    let answer = loop {
        let _ = stream.write_all(b" ");
        let answer = read(&mut stream);
        if answer.status != 0 {
            break answer;
        }
        assert!(begun.elapsed() < Duration::from_secs(30), "it waits");
    };
    assert_eq!(answer.status, 408);
}

#[test]
fn a_page_that_sends_much_or_takes_nothing_disturbs_no_other() {
    let ground = Ground::new();
    let daemon = Daemon::start("greedy");
    wait_for(&ground, &daemon);
    let upgrade = format!(
        "GET /api/live/{} HTTP/1.1\r\nHost: {}\r\n{}\r\n\r\n",
        daemon.instance,
        ground.address(),
        UPGRADE.join("\r\n")
    );
    // They take nothing from now on.
    let open: Vec<_> = (0..50)
        .map(|_| {
            let mut stream = ground.connect();
            stream.write_all(upgrade.as_bytes()).unwrap();
            stream
        })
        .collect();
    // This one sends a frame of 1 GB by its head, and bytes without an end.
    let mut loud = ground.connect();
    loud.write_all(upgrade.as_bytes()).unwrap();
    let frame = [0x82, 0xff, 0, 0, 0, 0, 0x40, 0, 0, 0, 1, 2, 3, 4];
    loud.write_all(&frame).unwrap();
    let (many, mut sent) = (vec![0; 65_536], 0);
    while sent < 16 << 20 && loud.write_all(&many).is_ok() {
        sent += 65_536;
    }
    assert!(sent < 16 << 20, "it is read to its end");
    let begun = Instant::now();
    assert_eq!(ground.get("/api/status").status, 200);
    assert!(begun.elapsed() < Duration::from_secs(2));
    drop(open);
}

#[test]
fn more_pages_than_there_is_room_for_are_refused() {
    let ground = Ground::new();
    let upgrade = format!(
        "GET /api/drafts HTTP/1.1\r\nHost: {}\r\n{}\r\n\r\n",
        ground.address(),
        UPGRADE.join("\r\n")
    );
    let connect = || {
        let mut stream = ground.connect();
        stream.write_all(upgrade.as_bytes()).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(5)))
            .unwrap();
        let mut begin = [0; 12];
        std::io::Read::read_exact(&mut stream, &mut begin).unwrap();
        (stream, String::from_utf8_lossy(&begin).into_owned())
    };
    let open: Vec<_> = (0..256).map(|_| connect()).collect();
    assert!(open.iter().all(|(_, begin)| begin == "HTTP/1.1 101"));
    assert_eq!(connect().1, "HTTP/1.1 503");
    assert_eq!(ground.get("/api/status").status, 200);
    drop(open);
    // Their places are free again.
    sleep(Duration::from_millis(500));
    assert_eq!(connect().1, "HTTP/1.1 101");
}
