//! The multicast group of the beacons, joined where the network leads now.
//!
//! The kernel joins a group at one interface: the one to which a route leads at
//! that moment. When a connection is opened there may be none yet, and later
//! another one: a phone's Wi-Fi comes and goes. So it is joined again and again,
//! by the thread that reports on the connection: never in a tick, since the
//! kernel may wait for a lock.

use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::udp_port::UdpPort;

/// Beacons come about once a second.
const JOIN_EVERY: Duration = Duration::from_secs(1);

/// The group of a socket that listens for beacons.
#[derive(Debug)]
pub(crate) struct BeaconGroup {
    socket: UdpSocket,
    group: Ipv4Addr,
    joined: Mutex<Option<Instant>>,
}

impl BeaconGroup {
    /// Of the port that listens, whose socket is duplicated; none for an address
    /// that is of no group.
    pub(crate) fn of(port: &UdpPort, group: SocketAddrV4) -> io::Result<Option<Self>> {
        if !group.ip().is_multicast() {
            return Ok(None);
        }
        Ok(Some(Self {
            socket: port.socket().try_clone()?,
            group: *group.ip(),
            joined: Mutex::new(None),
        }))
    }

    /// Joins the group where a route leads to it now, at most once a second.
    pub(crate) fn join(&self) {
        let mut joined = self.joined.lock().unwrap_or_else(PoisonError::into_inner);
        if joined.is_none_or(|at| at.elapsed() >= JOIN_EVERY) {
            *joined = Some(Instant::now());
            // Refused where it is joined already, and where there is no network.
            let _ = self
                .socket
                .join_multicast_v4(&self.group, &Ipv4Addr::UNSPECIFIED);
        }
    }
}
