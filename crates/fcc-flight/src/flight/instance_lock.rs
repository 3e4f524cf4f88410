//! One daemon for one simulator.
//!
//! Two that see the same engage switch would both take the controls and write
//! over each other. The first holds a name that the kernel gives to one socket
//! only (abstract, see unix(7)) and takes back when the process ends, however
//! it does: no file is left behind by a daemon that was killed.
//!
//! The name is made of the simulator's address, and not of how a configuration
//! finds it: who follows a beacon claims once the beacon has told the address,
//! and takes no control before.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr as SocketName, UnixDatagram};

use fcc_xplane::XPlaneStatus;

/// The right to fly a simulator; given up when dropped.
pub(super) struct InstanceLock {
    status: XPlaneStatus,
    claim: Claim,
}

enum Claim {
    /// Nobody has told where there is a simulator.
    Nowhere,
    /// Where the kernel has no such names, nobody is kept from flying.
    Had {
        simulator: SocketAddr,
        _name: Option<UnixDatagram>,
    },
    /// Another daemon flies it.
    Taken(SocketAddr),
}

impl InstanceLock {
    /// Claims what the connection leads to, if that is known yet. From here on
    /// control is taken only of what was claimed.
    pub(super) fn of(status: XPlaneStatus) -> Self {
        status.ask_first();
        let mut this = Self {
            status,
            claim: Claim::Nowhere,
        };
        this.follow();
        this
    }

    /// Claims the simulator that a beacon has told of since. It stays the same
    /// while its controls are held, so none is given up that is still flown.
    pub(super) fn follow(&mut self) {
        let Some(simulator) = self.status.simulator() else {
            return;
        };
        if matches!(self.claim, Claim::Had { simulator: of, .. } | Claim::Taken(of) if of == simulator)
        {
            return;
        }
        self.claim = match claim(simulator) {
            Err(error) if error.kind() == io::ErrorKind::AddrInUse => Claim::Taken(simulator),
            claimed => {
                self.status.allow(simulator);
                Claim::Had {
                    simulator,
                    _name: claimed.ok(),
                }
            }
        };
    }

    /// Where another daemon flies, if that is where this one was to.
    pub(super) const fn taken(&self) -> Option<SocketAddr> {
        match self.claim {
            Claim::Taken(simulator) => Some(simulator),
            Claim::Nowhere | Claim::Had { .. } => None,
        }
    }
}

/// `AddrInUse` if another daemon of this machine has it.
fn claim(simulator: SocketAddr) -> io::Result<UnixDatagram> {
    UnixDatagram::bind_addr(&SocketName::from_abstract_name(name(simulator))?)
}

/// X-Plane listens at every address of its machine, so one on this machine has
/// one name, whichever of them it goes by.
fn name(simulator: SocketAddr) -> String {
    let here = simulator.ip().is_loopback() || is_of_this_machine(simulator);
    let ip = if here {
        Ipv4Addr::LOCALHOST.into()
    } else {
        simulator.ip()
    };
    format!("fccd/x-plane/{ip}:{}", simulator.port())
}

/// The kernel binds a socket to no other.
fn is_of_this_machine(mut address: SocketAddr) -> bool {
    address.set_port(0);
    UdpSocket::bind(address).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A port that is nobody else's while the socket lives.
    fn port() -> (UdpSocket, u16) {
        let socket = UdpSocket::bind("0.0.0.0:0").unwrap();
        let port = socket.local_addr().unwrap().port();
        (socket, port)
    }

    #[test]
    fn a_simulator_is_claimed_once_and_given_up() {
        let ((_one, port), (_other, other)) = (port(), port());
        let simulator = (Ipv4Addr::LOCALHOST, port).into();
        let first = claim(simulator).unwrap();
        let error = claim(simulator).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::AddrInUse);
        assert!(claim((Ipv4Addr::LOCALHOST, other).into()).is_ok());
        drop(first);
        assert!(claim(simulator).is_ok());
    }

    #[test]
    fn another_address_of_this_machine_is_the_same_simulator() {
        let (_socket, port) = port();
        let _first = claim((Ipv4Addr::LOCALHOST, port).into()).unwrap();
        assert!(claim(([127, 9, 9, 9], port).into()).is_err());
        assert!(claim((std::net::Ipv6Addr::LOCALHOST, port).into()).is_err());
        // Of a block kept for documents (RFC 5737), so nobody's.
        assert!(claim(([192, 0, 2, 1], port).into()).is_ok());
    }
}
