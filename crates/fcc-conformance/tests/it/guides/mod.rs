//! The sensor of docs/guides/add-a-sensor.md and the actuator of
//! docs/guides/add-an-actuator.md, with their conformance suites.

mod barometer;
mod servo_board;

use std::io;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::SocketAddr;
use std::sync::atomic::{AtomicU32, Ordering};

/// A socket address that no other test has.
fn address() -> SocketAddr {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!("fcc-guide-{}-{number}", std::process::id());
    SocketAddr::from_abstract_name(name).unwrap()
}

/// The error number of a failed call; 0 if there was none.
fn errno(error: &io::Error) -> i32 {
    error.raw_os_error().unwrap_or(0)
}
