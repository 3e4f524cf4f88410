//! Who asks much, sends much or takes nothing: others are served, and a command is carried
//! out. Each test is an attack by its name.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt as _;
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use serde_json::json;

use crate::attacks::UPGRADE;
use crate::common::{Answer, Daemon, Ground, request, utc_ms, wait_for};
use crate::flights::{fly, name};

/// Of a station that is not kept busy, with a large margin for a machine that is.
const SOON: Duration = Duration::from_secs(10);

fn asked(ground: &Ground, path: &str) -> TcpStream {
    let host = format!("Host: {}", ground.address());
    let mut stream = ground.connect();
    let _ = stream.write_all(request(&format!("GET {path}"), &[&host], "").as_bytes());
    stream
}

fn commanded(ground: &Ground, daemon: &Daemon, number: u64) -> Answer {
    let body =
        json!({ "number": number, "deadline_ms_utc": utc_ms() + 30_000, "command": "pause" });
    let what = format!("POST /api/live/{}/command", daemon.instance);
    ground.change(&what, &body)
}

/// Whether the other end has closed a connection whose bytes are not of interest.
fn is_closed(stream: &mut TcpStream) -> bool {
    stream.set_read_timeout(Some(SOON)).unwrap();
    let mut bytes = vec![0; 65_536];
    loop {
        match stream.read(&mut bytes) {
            Ok(0) => return true,
            Ok(_) => {}
            Err(error) => return error.kind() == std::io::ErrorKind::ConnectionReset,
        }
    }
}

/// As many files as there are threads, of which nobody takes more than the head, and as many
/// curves again and again.
#[test]
fn readers_and_downloads_that_are_not_taken_delay_no_command() {
    let ground = Ground::new();
    let daemon = Daemon::start("readers");
    let file = name(&fly(&ground, 1_795_148_400, 600, false, true));
    wait_for(&ground, &daemon);
    let mut open = Vec::new();
    for _ in 0..20 {
        open.push(asked(
            &ground,
            &format!("/api/flights/{file}/download?format=csv"),
        ));
    }
    for _ in 0..40 {
        open.push(asked(&ground, &format!("/api/flights/{file}/report")));
        open.push(asked(
            &ground,
            &format!("/api/flights/{file}/data?columns=tick"),
        ));
    }
    let begun = Instant::now();
    let answer = commanded(&ground, &daemon, 1);
    assert_eq!(answer.status, 200, "{}", answer.text());
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());
    let answer = ground.change("PUT /api/drafts/a", &json!({ "plan": {} }));
    assert_eq!(answer.status, 200, "{}", answer.text());
    drop(open);
}

#[test]
fn more_downloads_than_there_is_room_for_are_refused() {
    let ground = Ground::new();
    let file = name(&fly(&ground, 1_795_148_400, 600, false, true));
    let path = format!("/api/flights/{file}/download?format=csv");
    let open: Vec<_> = (0..4).map(|_| asked(&ground, &path)).collect();
    let mut head = [0; 12];
    for mut stream in &open {
        stream.read_exact(&mut head).unwrap();
        assert_eq!(&head, b"HTTP/1.1 200");
    }
    assert_eq!(ground.get(&path).status, 503);
    drop(open);
    let begun = Instant::now();
    while ground.get(&path).status != 200 {
        assert!(begun.elapsed() < SOON, "their places are taken");
        sleep(Duration::from_millis(50));
    }
}

/// Its bytes wait for somebody who never takes them: the connection, its memory and its
/// place are given up.
#[test]
fn an_answer_that_is_not_taken_is_given_up() {
    let ground = Ground::new();
    let file = name(&fly(&ground, 1_795_148_400, 600, false, true));
    let path = format!("/api/flights/{file}/download?format=csv");
    let open: Vec<_> = (0..4).map(|_| asked(&ground, &path)).collect();
    sleep(Duration::from_secs(2));
    assert_eq!(ground.get(&path).status, 503);
    let begun = Instant::now();
    while ground.get(&path).status != 200 {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "it waits for ever"
        );
        sleep(Duration::from_secs(1));
    }
    drop(open);
}

#[test]
fn a_column_that_is_wanted_a_thousand_times_is_refused() {
    let ground = Ground::new();
    let file = name(&fly(&ground, 1_795_148_400, 10, false, true));
    let many = vec!["tick"; 1_000].join(",");
    for points in ["", "&points=100", "&points=18446744073709551615"] {
        let path = format!("/api/flights/{file}/data?columns={many}{points}");
        assert_eq!(ground.get(&path).status, 400, "{points}");
        let path = format!("/api/flights/{file}/data?columns=tick,woke_ns{points}");
        assert_eq!(ground.get(&path).status, 200, "{points}");
    }
}

#[test]
fn connections_without_an_end_keep_nobody_out() {
    let ground = Ground::new();
    let idle: Vec<_> = (0..700).map(|_| ground.connect()).collect();
    // They are closed after 10 s.
    let begun = Instant::now();
    assert_eq!(ground.get("/api/status").status, 200);
    assert!(begun.elapsed() < Duration::from_secs(30));
    drop(idle);
}

#[test]
fn requests_that_are_sent_ahead_disturb_no_other() {
    let ground = Ground::new();
    let one = format!(
        "GET /api/status HTTP/1.1\r\nHost: {}\r\n\r\n",
        ground.address()
    );
    let many = one.repeat(1_000);
    let mut ahead = ground.connect();
    ahead
        .set_write_timeout(Some(Duration::from_secs(1)))
        .unwrap();
    // Until it takes no more, for nobody takes the answers.
    for _ in 0..100 {
        if ahead.write_all(many.as_bytes()).is_err() {
            break;
        }
    }
    let begun = Instant::now();
    assert_eq!(ground.get("/api/status").status, 200);
    assert!(begun.elapsed() < SOON);
}

#[test]
fn the_doctor_is_called_once_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let (program, count) = (folder.path().join("fccd"), folder.path().join("count"));
    let script = format!(
        "#!/bin/sh\nmkdir {0} || echo twice >> {1}\nsleep 0.2\nrmdir {0}\necho once >> {1}\n\
         echo '{{\"findings\":[]}}'\n",
        folder.path().join("running").display(),
        count.display()
    );
    std::fs::write(&program, script).unwrap();
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o700)).unwrap();
    let ground = Ground::with(&["--fccd", program.to_str().unwrap()]);
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| assert_eq!(ground.get("/api/doctor").status, 200));
        }
    });
    let calls = std::fs::read_to_string(&count).unwrap();
    assert_eq!(calls, "once\n".repeat(8));
}

#[test]
fn a_draft_more_than_there_is_room_for_is_refused() {
    let ground = Ground::new();
    let draft = json!({ "name": "a", "revision": 1, "changed_utc_s": 0.0, "plan": {} }).to_string();
    for number in 0..500 {
        ground.write(&format!("state/drafts/{number}.json"), draft.as_bytes());
    }
    let answer = ground.change("PUT /api/drafts/more", &json!({ "plan": {} }));
    assert_eq!(answer.status, 409, "{}", answer.text());
    assert_eq!(
        ground.change("DELETE /api/drafts/7", &json!(null)).status,
        204
    );
    let answer = ground.change("PUT /api/drafts/more", &json!({ "plan": {} }));
    assert_eq!(answer.status, 200, "{}", answer.text());
}

#[test]
fn an_area_or_a_part_of_a_map_without_an_end_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("map.pmtiles");
    std::fs::write(&map, [b"PMTiles".as_slice(), &vec![0; 100_000]].concat()).unwrap();
    let ground = Ground::with(&["--map", map.to_str().unwrap()]);
    for area in [
        "south=1&west=1&north=2&east=2&n=18446744073709551615",
        "south=1&west=1&north=2&east=2&n=1000000",
        "south=1&west=1&north=2&east=2&n=-1",
        "south=NaN&west=NaN&north=NaN&east=NaN&n=10",
        "south=-inf&west=-inf&north=inf&east=inf&n=10",
        "south=-90&west=-180&north=90&east=180&n=10",
        "south=1e308&west=1&north=1e308&east=2&n=10",
        "south=2&west=2&north=1&east=1&n=10",
    ] {
        let answer = ground.get(&format!("/api/terrain?{area}"));
        assert_eq!(answer.status, 400, "{area}");
    }
    let many = format!("bytes={}", vec!["0-"; 1_300].join(","));
    for range in [
        many.as_str(),
        "bytes=0-9,5-20",
        "bytes=-1",
        "bytes=200000-",
        "lines=0-9",
    ] {
        let line = format!("Range: {range}");
        let answer = ground.send("GET /map.pmtiles", &[&line], "");
        assert_eq!(answer.status, 416, "{range}");
        assert!(answer.body.len() < 1_000);
    }
    assert_eq!(ground.get("/map.pmtiles").status, 416);
    let answer = ground.send("GET /map.pmtiles", &["Range: bytes=0-6"], "");
    assert_eq!((answer.status, answer.text().as_str()), (206, "PMTiles"));
}

fn socket(ground: &Ground, path: &str) -> TcpStream {
    let mut stream = ground.connect();
    let host = ground.address();
    let lines = UPGRADE.join("\r\n");
    let head = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n{lines}\r\n\r\n");
    stream.write_all(head.as_bytes()).unwrap();
    let mut begin = [0; 12];
    stream.read_exact(&mut begin).unwrap();
    assert_eq!(&begin, b"HTTP/1.1 101");
    stream
}

#[test]
fn frames_that_are_none_end_their_connection() {
    let ground = Ground::new();
    for (what, frame) in [
        ("not masked", b"\x81\x02hi".to_vec()),
        (
            "compressed, which was not agreed",
            b"\xc1\x82\0\0\0\0hi".to_vec(),
        ),
        ("an unknown kind", b"\x83\x80\0\0\0\0".to_vec()),
        ("a ping in pieces", b"\x09\x80\0\0\0\0".to_vec()),
        (
            "a ping that is too long",
            [b"\x89\xfe\x01\x00\0\0\0\0".as_slice(), &[0; 256]].concat(),
        ),
        ("no text", b"\x81\x82\0\0\0\0\xff\xfe".to_vec()),
        ("the middle of nothing", b"\x80\x80\0\0\0\0".to_vec()),
        (
            "a length of 2^63",
            b"\x82\xff\x80\0\0\0\0\0\0\0\0\0\0\0".to_vec(),
        ),
    ] {
        let mut stream = socket(&ground, "/api/drafts");
        stream.write_all(&frame).unwrap();
        assert!(is_closed(&mut stream), "{what}");
    }
    assert_eq!(ground.get("/api/status").status, 200);
}

#[test]
fn pieces_of_a_message_without_an_end_are_not_collected() {
    let ground = Ground::new();
    let mut stream = socket(&ground, "/api/drafts");
    let piece = |kind: u8| {
        [
            &[kind, 0xfe, 0x04, 0x00, 0, 0, 0, 0],
            [b'a'; 1_024].as_slice(),
        ]
        .concat()
    };
    let mut sent = stream.write_all(&piece(0x01));
    for _ in 0..1_000 {
        sent = sent.and_then(|()| stream.write_all(&piece(0x00)));
    }
    assert!(sent.is_err() || is_closed(&mut stream), "1 MB is collected");
}

#[test]
fn pings_without_an_end_disturb_no_other() {
    let ground = Ground::new();
    let mut stream = socket(&ground, "/api/drafts");
    stream
        .set_write_timeout(Some(Duration::from_secs(1)))
        .unwrap();
    let pings = b"\x89\x84\0\0\0\0ping".repeat(10_000);
    // Nobody takes what is answered.
    for _ in 0..100 {
        if stream.write_all(&pings).is_err() {
            break;
        }
    }
    let begun = Instant::now();
    assert_eq!(ground.get("/api/status").status, 200);
    assert!(begun.elapsed() < SOON);
}

/// A page whose machine was switched off says nothing more, and does not answer.
#[test]
fn a_page_that_is_gone_without_a_word_is_closed() {
    let ground = Ground::new();
    let mut stream = socket(&ground, "/api/drafts");
    stream
        .set_read_timeout(Some(Duration::from_secs(60)))
        .unwrap();
    let begun = Instant::now();
    let mut all = Vec::new();
    let _ = stream.read_to_end(&mut all);
    let after = begun.elapsed();
    assert!(
        after > Duration::from_secs(15) && after < Duration::from_secs(55),
        "{after:?}"
    );
}
