//! A station on a port of its own, a daemon for it, and a client that sends any bytes.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use clap::Parser as _;
use fcc_core::framework::{State, Tick, Time};
use fcc_ground::{Cli, Running, runtime, start};
use fcc_live::{Info, PendingCommand, Publisher, Text, Verdict};
use fcc_telemetry::{FlightRecord, Instance};
use serde_json::Value;
use tempfile::TempDir;
use tokio::runtime::Runtime;

const PATIENCE: Duration = Duration::from_secs(40);

pub(crate) struct Ground {
    pub(crate) runtime: Runtime,
    pub(crate) running: Running,
    pub(crate) folder: TempDir,
}

/// An answer: its status, its head and its body.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("no JSON: {}", self.text()))
    }

    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.head.lines().find_map(|line| {
            let (found, value) = line.split_once(": ")?;
            found.eq_ignore_ascii_case(name).then_some(value)
        })
    }
}

impl Ground {
    pub(crate) fn new() -> Self {
        Self::with(&[])
    }

    /// With further options.
    pub(crate) fn with(options: &[&str]) -> Self {
        Self::in_folder(tempfile::tempdir().unwrap(), options)
    }

    /// Another station that takes up the state of one.
    pub(crate) fn again(before: Self) -> Self {
        Self::again_with(before, &[])
    }

    pub(crate) fn again_with(before: Self, options: &[&str]) -> Self {
        before.running.stop();
        Self::in_folder(before.folder, options)
    }

    fn in_folder(folder: TempDir, options: &[&str]) -> Self {
        let path = |name: &str| folder.path().join(name).display().to_string();
        let (state, recordings) = (path("state"), path("recordings"));
        let words = ["fcc-ground", "--listen", "127.0.0.1:0", "--state", &state];
        let words = words.into_iter().chain(["--recordings", &recordings]);
        let cli = Cli::parse_from(words.chain(options.iter().copied()));
        let runtime = runtime().unwrap();
        let running = runtime.block_on(start(cli)).unwrap();
        Self {
            runtime,
            running,
            folder,
        }
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.running.address
    }

    pub(crate) fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn bearer(&self) -> String {
        format!("Authorization: Bearer {}", self.running.token.as_str())
    }

    /// Sends any bytes, and reads the answer to its end.
    pub(crate) fn raw(&self, request: &[u8]) -> Answer {
        let mut stream = self.connect();
        // A server that has refused it may have closed it.
        let _ = stream.write_all(request);
        read(&mut stream)
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// A request as this page makes it, with further lines in its head.
    pub(crate) fn send(&self, what: &str, lines: &[&str], body: &str) -> Answer {
        let host = format!("Host: {}", self.address());
        let all: Vec<&str> = [host.as_str()]
            .into_iter()
            .chain(lines.iter().copied())
            .collect();
        self.raw(request(what, &all, body).as_bytes())
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        self.send(&format!("GET {path}"), &[], "")
    }

    /// With the token, as JSON.
    pub(crate) fn change(&self, what: &str, body: &Value) -> Answer {
        let bearer = self.bearer();
        let lines = [bearer.as_str(), "Content-Type: application/json"];
        self.send(what, &lines, &body.to_string())
    }

    pub(crate) fn write(&self, path: &str, content: &[u8]) {
        let path = self.path(path);
        std::fs::create_dir_all(path.parent().unwrap_or_else(|| Path::new("/"))).unwrap();
        std::fs::write(path, content).unwrap();
    }
}

pub(crate) fn request(what: &str, lines: &[&str], body: &str) -> String {
    let lines = [lines, &[""]].concat().join("\r\n");
    let length = if body.is_empty() && what.starts_with("GET") {
        String::new()
    } else {
        format!("Content-Length: {}\r\n", body.len())
    };
    format!("{what} HTTP/1.1\r\n{lines}{length}Connection: close\r\n\r\n{body}")
}

/// The answer; a status of 0 if there was none.
pub(crate) fn read(stream: &mut TcpStream) -> Answer {
    let mut all = Vec::new();
    let _ = stream.read_to_end(&mut all);
    let end = all.windows(4).position(|four| four == b"\r\n\r\n");
    let (head, body) = end.map_or((all.as_slice(), &[][..]), |end| {
        (&all[..end], &all[end + 4..])
    });
    let head = String::from_utf8_lossy(head).into_owned();
    let status = head.split(' ').nth(1).and_then(|code| code.parse().ok());
    let is_chunked = head
        .to_ascii_lowercase()
        .contains("transfer-encoding: chunked");
    Answer {
        status: status.unwrap_or(0),
        body: if is_chunked {
            unchunked(body)
        } else {
            body.to_vec()
        },
        head,
    }
}

fn unchunked(mut body: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    while let Some(end) = body.windows(2).position(|two| two == b"\r\n") {
        let length = std::str::from_utf8(&body[..end]).unwrap();
        let length = usize::from_str_radix(length, 16).unwrap();
        all.extend_from_slice(&body[end + 2..end + 2 + length]);
        body = &body[end + 2 + length + 2..];
        if length == 0 {
            break;
        }
    }
    all
}

/// Publishes 40 ticks a second, in each the same flight, and carries out every command.
pub(crate) struct Daemon {
    pub(crate) instance: Instance,
    pub(crate) commands: Receiver<PendingCommand>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Daemon {
    pub(crate) fn start(test: &str) -> Self {
        let instance: Instance = format!("ground-{}-{test}", std::process::id())
            .parse()
            .unwrap();
        let (name, ends) = (instance.clone(), Arc::new(AtomicBool::new(false)));
        let (send, commands) = channel();
        let ended = Arc::clone(&ends);
        let thread = thread::spawn(move || {
            let mut publisher = Publisher::start_with_commands(&name, 2_048).unwrap();
            publisher.describe(Info {
                rate_hz: 40.0,
                plant: Text::new("<b>test</b>"),
                ..Info::of_this_process()
            });
            let mut number = 0;
            while !ended.load(Ordering::Relaxed) {
                number += 1;
                publisher.record(&record(number));
                while let Some(asked) = publisher.next_command() {
                    send.send(asked.clone()).unwrap();
                    publisher.answer(asked.id, Verdict::CarriedOut { tick: number });
                }
                publisher.flush();
                thread::sleep(Duration::from_millis(25));
            }
        });
        Self {
            instance,
            commands,
            ends,
            thread: Some(thread),
        }
    }

    pub(crate) fn end(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        self.end();
    }
}

fn record(number: u64) -> FlightRecord {
    let tick = Tick {
        number,
        woke: Time::from_nanos(number.cast_signed() * 25_000_000),
        ..Tick::default()
    };
    let mut record = FlightRecord::new(tick, State::Engaged);
    record.estimate.altitude_m = 1_000.25;
    record.estimate.roll_rad = -0.5;
    record.estimate.latitude_rad = 0.5 + number as f64 * 1e-4;
    record.estimate.longitude_rad = 0.1;
    record
}

/// Waits until the station watches a daemon.
pub(crate) fn wait_for(ground: &Ground, daemon: &Daemon) {
    for _ in 0..400 {
        if ground
            .get(&format!("/api/live/{}/columns", daemon.instance))
            .status
            == 200
        {
            return;
        }
        thread::sleep(Duration::from_millis(25));
    }
    panic!(
        "the daemon is not watched: {}",
        ground.get("/api/status").text()
    );
}

pub(crate) fn utc_ms() -> u64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.unwrap().as_millis() as u64
}
