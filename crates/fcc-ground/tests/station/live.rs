//! Live telemetry as a page receives it.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use futures_util::{SinkExt as _, StreamExt as _};
use serde_json::Value;
use tokio::net::{TcpSocket, TcpStream};
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, client_async, connect_async};

use crate::common::{Daemon, Ground, wait_for};

type Socket = WebSocketStream<MaybeTlsStream<TcpStream>>;

async fn connect(ground: &Ground, path: &str) -> Socket {
    connect_async(format!("ws://{}{path}", ground.address()))
        .await
        .unwrap()
        .0
}

async fn next(socket: &mut Socket) -> Message {
    let next = tokio::time::timeout(Duration::from_secs(10), socket.next()).await;
    next.expect("nothing came").unwrap().unwrap()
}

fn json(message: &Message) -> Value {
    serde_json::from_str(message.to_text().unwrap()).unwrap()
}

/// The words of a record, by the names of their columns.
fn words(hello: &Value, record: &[u8]) -> BTreeMap<String, u64> {
    let columns = hello["hello"]["columns"].as_array().unwrap();
    assert_eq!(record.len(), 8 * columns.len());
    let names = columns
        .iter()
        .map(|column| column["name"].as_str().unwrap().to_owned());
    let words = record
        .chunks(8)
        .map(|word| u64::from_le_bytes(word.try_into().unwrap()));
    names.zip(words).collect()
}

#[test]
fn a_page_gets_the_ticks_of_a_daemon_until_it_ends() {
    let ground = Ground::new();
    let mut daemon = Daemon::start("ticks");
    wait_for(&ground, &daemon);
    ground.runtime.block_on(async {
        let path = format!("/api/live/{}", daemon.instance);
        let mut socket = connect(&ground, &path).await;
        let hello = json(&next(&mut socket).await);
        assert_eq!(hello["hello"]["rate_hz"], 40.0);
        let mut ticks = Vec::new();
        let mut statuses = 0;
        while ticks.len() < 60 || statuses == 0 {
            match next(&mut socket).await {
                Message::Binary(record) => {
                    let words = words(&hello, &record);
                    ticks.push(words["tick"]);
                    assert_eq!(f64::from_bits(words["estimated_altitude_m"]), 1_000.25);
                    assert_eq!(f64::from_bits(words["estimated_roll_rad"]), -0.5);
                    assert_eq!(words["state"], 1);
                    assert_eq!(words["woke_ns"], words["tick"] * 25_000_000);
                }
                Message::Text(text) => {
                    let text: Value = serde_json::from_str(&text).unwrap();
                    statuses += usize::from(text["status"]["ticks"].is_u64());
                }
                _ => {}
            }
        }
        assert!(ticks.is_sorted() && ticks.windows(2).all(|two| two[0] < two[1]));
        let states = &hello["hello"]["columns"].as_array().unwrap();
        let state = states
            .iter()
            .find(|column| column["name"] == "state")
            .unwrap();
        assert_eq!(state["names"][1], "engaged");
        daemon.end();
        loop {
            if let Message::Text(text) = next(&mut socket).await
                && text.contains("\"end\"")
            {
                break;
            }
        }
    });
    let gone = format!("/api/live/{}/columns", daemon.instance);
    for _ in 0..100 {
        if ground.get(&gone).status == 404 {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("it is still there");
}

/// As its second message: places in degrees, thinned out.
#[test]
fn a_page_gets_the_track_so_far() {
    let ground = Ground::new();
    let daemon = Daemon::start("track");
    wait_for(&ground, &daemon);
    ground.runtime.block_on(async {
        let path = format!("/api/live/{}", daemon.instance);
        // The daemon flies 0.0001 rad, 637 m, to the north in each tick.
        tokio::time::sleep(Duration::from_secs(1)).await;
        let mut socket = connect(&ground, &path).await;
        next(&mut socket).await;
        let track = json(&next(&mut socket).await);
        let places = track["track"].as_array().unwrap();
        assert!(places.len() > 10, "{track}");
        for two in places.windows(2) {
            let north = two[1][0].as_f64().unwrap() - two[0][0].as_f64().unwrap();
            // 0.0001 rad are 0.0057296°; a tick may be missing.
            assert!((north / 0.005_729_6).round() >= 1.0, "{track}");
            assert_eq!(two[1][1], 5.729_578);
        }
    });
}

/// Of 240 ticks of 1.6 kB nobody keeps those that were not taken, but the last.
#[test]
fn a_page_that_was_slow_gets_the_newest_tick() {
    let ground = Ground::new();
    let daemon = Daemon::start("slow");
    wait_for(&ground, &daemon);
    ground.runtime.block_on(async {
        let socket = TcpSocket::new_v4().unwrap();
        // Of the kernel, what it receives for a page that does not take it.
        socket.set_recv_buffer_size(4_096).unwrap();
        let stream = socket.connect(ground.address()).await.unwrap();
        let address = format!("ws://{}/api/live/{}", ground.address(), daemon.instance);
        let mut socket = client_async(address, stream).await.unwrap().0;
        let mut hello = Value::Null;
        let mut tick = async |socket: &mut WebSocketStream<TcpStream>| loop {
            match socket.next().await.unwrap().unwrap() {
                Message::Binary(record) => return words(&hello, &record)["tick"],
                Message::Text(text) if hello.is_null() => {
                    hello = serde_json::from_str(&text).unwrap();
                }
                _ => {}
            }
        };
        let first = tick(&mut socket).await;
        tokio::time::sleep(Duration::from_secs(6)).await;
        let (mut last, mut longest, mut received) = (first, 0, 0);
        while last < first + 220 {
            let next = tick(&mut socket).await;
            (longest, last, received) = (longest.max(next - last), next, received + 1);
        }
        assert!(
            longest > 120,
            "it got {received} ticks, {longest} apart at most"
        );
    });
}

#[test]
fn a_change_of_a_draft_is_told_to_other_pages() {
    let ground = Ground::new();
    ground.runtime.block_on(async {
        let mut socket = connect(&ground, "/api/drafts").await;
        socket.send(Message::text("hello")).await.unwrap();
        let saved = tokio::task::block_in_place(|| {
            ground
                .change("PUT /api/drafts/a", &serde_json::json!({ "plan": {} }))
                .json()
        });
        let told = loop {
            if let message @ Message::Text(_) = next(&mut socket).await {
                break json(&message);
            }
        };
        assert_eq!(told["name"], "a");
        assert_eq!(told["revision"], saved["revision"]);
    });
}

/// Files of daemons whose name has this in it that this process has open.
fn open_files(of: &str) -> usize {
    let files = std::fs::read_dir("/proc/self/fd").unwrap().flatten();
    let links = files.filter_map(|file| std::fs::read_link(file.path()).ok());
    let names = links.map(|link| link.display().to_string());
    names.filter(|name| name.contains(of)).count()
}

#[test]
fn pages_and_daemons_that_come_and_go_leave_nothing_open() {
    let ground = Ground::new();
    for number in 0..4 {
        let mut daemon = Daemon::start(&format!("round-{number}"));
        wait_for(&ground, &daemon);
        ground.runtime.block_on(async {
            let path = format!("/api/live/{}", daemon.instance);
            for _ in 0..20 {
                let mut socket = connect(&ground, &path).await;
                next(&mut socket).await;
            }
            // Those that have left are not counted any more.
            let mut socket = connect(&ground, &path).await;
            loop {
                let message = next(&mut socket).await;
                if message.is_text() && json(&message)["status"]["station"]["clients"] == 1 {
                    break;
                }
            }
        });
        assert!(open_files("-round-") > 0);
        daemon.end();
    }
    // Another publisher of a process that lives, as this one does, is waited for: 5 s.
    let deadline = Instant::now() + Duration::from_secs(30);
    while Instant::now() < deadline {
        if open_files("-round-") == 0 {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("{} files of daemons that have ended", open_files("-round-"));
}
