//! One daemon for one simulator.
//!
//! Two that see the same engage switch would both take the controls and write
//! over each other. The first holds a name that the kernel gives to one socket
//! only (abstract, see unix(7)) and takes back when the process ends, however
//! it does: no file is left behind by a daemon that was killed.

use std::io;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixDatagram};

use fcc_xplane::Simulator;

/// The right to fly a simulator; given up when dropped.
pub(super) struct Sole {
    _name: UnixDatagram,
}

impl Sole {
    /// Claims a simulator among the daemons of this machine.
    ///
    /// # Errors
    /// `AddrInUse` if another daemon flies it.
    pub(super) fn claim(simulator: Simulator) -> io::Result<Self> {
        let name = match simulator {
            Simulator::Beacon => "fccd/x-plane/beacon".to_owned(),
            Simulator::At(address) => format!("fccd/x-plane/{address}"),
        };
        let address = SocketAddr::from_abstract_name(name)?;
        Ok(Self {
            _name: UnixDatagram::bind_addr(&address)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simulator_is_claimed_once_and_given_up() {
        let simulator = Simulator::At("127.0.0.1:1".parse().unwrap());
        let first = Sole::claim(simulator).unwrap();
        let Err(error) = Sole::claim(simulator) else {
            panic!("claimed twice");
        };
        assert_eq!(error.kind(), io::ErrorKind::AddrInUse);
        let other = Simulator::At("127.0.0.1:2".parse().unwrap());
        assert!(Sole::claim(other).is_ok());
        drop(first);
        assert!(Sole::claim(simulator).is_ok());
    }
}
