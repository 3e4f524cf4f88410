//! What a test tells the sensors.
#![allow(unsafe_code, reason = "a test calls it by its symbol's name")]

use std::ffi::{CStr, c_char, c_int};
use std::net::UdpSocket;
use std::sync::Once;
use std::thread;

use serde::Deserialize;

use crate::performance_hints::{self, PlayedHints};
use crate::played::{Fed, PLAYED, Played};

/// Where datagrams are listened for, on this machine alone.
const PORT: &str = "FAKE_LIBANDROID_PORT";
/// A file of lines that are obeyed before the first sensor is asked for.
const SCRIPT: &str = "FAKE_LIBANDROID_SCRIPT";
/// The longest datagram.
const LONGEST: usize = 65_536;

/// One line.
#[derive(Deserialize)]
#[serde(untagged)]
enum Line {
    Sensor(SensorLine),
    PerformanceHints(HintsLine),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HintsLine {
    /// How they are played from now on.
    performance_hints: PlayedHints,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SensorLine {
    package: String,
    #[serde(rename = "type")]
    of_type: i32,
    /// How the sensor is played from now on.
    #[serde(default)]
    sensor: Option<Played>,
    /// An event now.
    #[serde(default)]
    event: Option<Fed>,
}

/// Does what lines say, up to the first that is none.
fn obey(lines: &str) -> Result<(), serde_json::Error> {
    for line in lines.lines().filter(|line| !line.trim().is_empty()) {
        let line = match serde_json::from_str(line)? {
            Line::Sensor(line) => line,
            Line::PerformanceHints(line) => {
                performance_hints::play(line.performance_hints);
                continue;
            }
        };
        if let Some(sensor) = line.sensor {
            PLAYED.set(&line.package, line.of_type, sensor);
        }
        if let Some(event) = &line.event {
            PLAYED.feed(&line.package, line.of_type, event);
        }
    }
    Ok(())
}

/// Does what JSON says; 0, or -1 if it cannot be understood.
///
/// # Safety
/// `text` ends with 0.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn fake_libandroid_control(text: *const c_char) -> c_int {
    // SAFETY: as the caller says.
    let text = unsafe { CStr::from_ptr(text) };
    let obeyed = text.to_str().map(obey);
    if matches!(obeyed, Ok(Ok(()))) { 0 } else { -1 }
}

/// Reads the script, and begins to listen for datagrams, if that is asked for.
pub(crate) fn listen() {
    static BEGUN: Once = Once::new();
    BEGUN.call_once(|| {
        let script = std::env::var_os(SCRIPT).and_then(|path| std::fs::read_to_string(path).ok());
        // What is wrong with it shows in the test.
        let _ = script.map(|lines| obey(&lines));
        let port = std::env::var(PORT)
            .ok()
            .and_then(|port| port.parse::<u16>().ok());
        let socket = port.and_then(|port| UdpSocket::bind(("127.0.0.1", port)).ok());
        if let Some(socket) = socket {
            thread::spawn(move || {
                let mut datagram = vec![0; LONGEST];
                while let Ok(length) = socket.recv(&mut datagram) {
                    let text = datagram.get(..length).unwrap_or_default();
                    // Who sent it does not wait for an answer.
                    let _ = std::str::from_utf8(text).map(obey);
                }
            });
        }
    });
}
