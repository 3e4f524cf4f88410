//! Shared by the tests: a minimal X-Plane, networks without sockets, and a clock
//! of ticks.
#![allow(
    dead_code,
    unused_imports,
    unreachable_pub,
    reason = "each test file is a crate of its own and uses its part"
)]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unreachable,
    reason = "a test fails by panicking, in what it shares too"
)]

pub mod bench;
mod fake_x_plane;
mod networks;

use std::hash::{BuildHasher, RandomState};
use std::net::UdpSocket;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU16, Ordering};
use std::time::Duration;

pub use fake_x_plane::FakeXPlane;
use fcc_core::framework::{Tick, Time};
pub use networks::{Addressed, Scripted, Wire};

pub const P: &str = "sim/flightmodel/position/";
pub const SWITCH: &str = "sim/cockpit2/switches/generic_lights_switch[56]";
pub const OVERRIDE_JOYSTICK: &str = "sim/operation/override/override_joystick";
pub const OVERRIDE_THROTTLES: &str = "sim/operation/override/override_throttles";
pub const YOKE_PITCH: &str = "sim/joystick/yoke_pitch_ratio";
pub const YOKE_ROLL: &str = "sim/joystick/yoke_roll_ratio";
pub const YOKE_HEADING: &str = "sim/joystick/yoke_heading_ratio";
pub const THROTTLE: &str = "sim/flightmodel/engine/ENGN_thro_use[0]";
pub const FLIGHT_TIME: &str = "sim/time/total_flight_time_sec";
pub const PAUSED: &str = "sim/time/paused";

/// A port of this machine that is free, and stays so: below the range from which the
/// kernel gives ports to the sockets of tests that run beside this one
/// (`ip_local_port_range` in ip(7): 32768 and above), and given once by this process.
/// No socket tries it: a program that is started at that moment would hold a copy of it
/// for a while.
pub fn free_port() -> u16 {
    static NEXT: LazyLock<AtomicU16> =
        LazyLock::new(|| AtomicU16::new((RandomState::new().hash_one(0) % 12_000) as u16));
    let opened = std::fs::read_to_string("/proc/net/udp").unwrap();
    loop {
        let port = 20_000 + NEXT.fetch_add(1, Ordering::Relaxed) % 12_000;
        if !opened.contains(&format!(":{port:04X} ")) {
            return port;
        }
    }
}

/// A reply to RPOS, written out from the layout.
pub fn position_reply(place: [f64; 3]) -> Vec<u8> {
    let mut datagram = b"RPOS4".to_vec();
    for field in place {
        datagram.extend(field.to_le_bytes());
    }
    for field in [
        900.0_f32, 2.5, 275.0, -20.0, -50.0, 1.0, 4.0, 0.01, -0.02, 0.03,
    ] {
        datagram.extend(field.to_le_bytes());
    }
    datagram
}

/// Ticks at 40 Hz on a clock set by the test: nothing waits.
pub struct Ticks {
    number: u64,
    pub now: Time,
}

impl Ticks {
    pub fn new() -> Self {
        Self {
            number: 0,
            now: Time::from_nanos(1_000_000_000_000),
        }
    }

    pub fn next(&mut self) -> Tick {
        self.number += 1;
        self.now = self.now + Duration::from_millis(25);
        Tick {
            number: self.number,
            scheduled: self.now,
            woke: self.now,
            missed: 0,
            dt_s: 0.025,
        }
    }
}
