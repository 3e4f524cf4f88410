//! Finding X-Plane by its beacon, before a loop runs.

use std::io;
use std::net::{SocketAddr, SocketAddrV4};
use std::time::{Duration, Instant};

use crate::protocol::beacon;
use crate::udp_port::UdpPort;

/// An X-Plane that sent a beacon.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Found {
    /// Where it listens.
    pub address: SocketAddrV4,
    /// Its version: 115501 is 11.55r01.
    pub version: u32,
    /// Its computer's name.
    pub computer: String,
}

/// Why no X-Plane was found.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum DiscoverError {
    /// Beacons cannot be received.
    #[error("cannot listen for X-Plane's beacon on {group}: {source}")]
    Listen {
        /// The multicast group and port.
        group: SocketAddrV4,
        /// The operating system's error.
        source: io::Error,
    },
    /// No beacon arrived.
    #[error(
        "no X-Plane announced itself on {group} within {} s: start X-Plane, or give its address \
         (some networks do not carry multicast)",
        waited.as_secs_f64()
    )]
    NotFound {
        /// The multicast group and port.
        group: SocketAddrV4,
        /// How long discovery waited.
        waited: Duration,
    },
}

/// Waits for the beacon of an X-Plane that computes a flight (not Plane Maker,
/// not an external visual); it sends one about every second. For set-up only:
/// this blocks. `group` is normally [`beacon::GROUP`].
///
/// # Errors
/// When listening is refused, or no beacon arrives in time.
pub fn discover(group: SocketAddrV4, timeout: Duration) -> Result<Found, DiscoverError> {
    let refused = |source| DiscoverError::Listen { group, source };
    let port = UdpPort::listen(group).map_err(refused)?;
    let socket = port.socket();
    socket.set_nonblocking(false).map_err(refused)?;
    let until = Instant::now() + timeout;
    let mut buffer = [0; 1_024];
    loop {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            let waited = timeout;
            return Err(DiscoverError::NotFound { group, waited });
        }
        socket.set_read_timeout(Some(left)).map_err(refused)?;
        let (length, from) = match socket.recv_from(&mut buffer) {
            Ok(received) => received,
            Err(error) => match error.kind() {
                io::ErrorKind::WouldBlock
                | io::ErrorKind::TimedOut
                | io::ErrorKind::Interrupted => continue,
                _ => return Err(refused(error)),
            },
        };
        let datagram = buffer.get(..length).unwrap_or_default();
        if let (Ok(beacon), SocketAddr::V4(from)) = (beacon::parse(datagram), from)
            && beacon.is_flyable()
        {
            return Ok(Found {
                address: SocketAddrV4::new(*from.ip(), beacon.port),
                version: beacon.version,
                computer: String::from_utf8_lossy(beacon.name).into_owned(),
            });
        }
    }
}
