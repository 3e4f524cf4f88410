//! A socket that exercises the kernel's datagram path without effect.
//!
//! A tick spends most of its datagram time in the kernel, and after 25 ms of
//! sleep that code is no longer in the caches either. On the simulator's socket
//! it cannot be run in advance without sending. So the same system calls are
//! made on a second socket, which is bound to the loopback interface and sends
//! to itself.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use crate::port::{Port, UdpPort};

/// Longer than what X-Plane sends.
pub(crate) const PEEK_BYTES: usize = 2_048;
/// More than are sent in a tick. Any remaining datagrams are received the next
/// time.
const MOST_RECEIVED: usize = 16;

/// A socket that sends to itself.
#[derive(Debug)]
pub(crate) struct ScratchPort {
    port: UdpPort,
    address: SocketAddr,
}

impl ScratchPort {
    /// Opens the socket, for the same kind of address as the simulator's.
    pub(crate) fn open(simulator: IpAddr) -> io::Result<Self> {
        let here: IpAddr = match simulator {
            IpAddr::V4(_) => Ipv4Addr::LOCALHOST.into(),
            IpAddr::V6(_) => Ipv6Addr::LOCALHOST.into(),
        };
        let port = UdpPort::bind_to((here, 0).into())?;
        let address = port.socket().local_addr()?;
        Ok(Self { port, address })
    }

    /// Sends datagrams of `size` bytes and receives them. A lost or refused
    /// datagram has no effect.
    pub(crate) fn send_to_itself(&self, datagrams: &[u8], size: usize) {
        let _ = self.port.send_each(datagrams, size, self.address);
        let mut taken = [0; PEEK_BYTES];
        for _ in 0..MOST_RECEIVED {
            if !matches!(self.port.receive(&mut taken), Ok(Some(_))) {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_receives_everything_that_it_sends() {
        for simulator in [Ipv4Addr::BROADCAST.into(), Ipv6Addr::LOCALHOST.into()] {
            let scratch = ScratchPort::open(simulator).unwrap();
            for _ in 0..3 {
                scratch.send_to_itself(&[7; 4 * 509], 509);
                let left = scratch.port.receive(&mut [0; PEEK_BYTES]);
                assert_eq!(left, Ok(None));
            }
        }
    }
}
