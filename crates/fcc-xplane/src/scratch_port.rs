//! A socket on which the kernel's path for datagrams is run without effect.
//!
//! Most of the time that a tick spends on its datagrams is spent in the kernel,
//! and after 25 ms of sleep that code is in no cache either. It cannot be run
//! ahead of time on the simulator's socket without sending. So the same system
//! calls are made on a second socket, which is bound to the loopback interface
//! and sends to itself.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use crate::port::{Port, UdpPort};

/// Longer than what X-Plane sends.
pub(crate) const PEEK_BYTES: usize = 2_048;
/// More than are sent for a tick. What is left is received the next time.
const MOST_RECEIVED: usize = 16;

/// A socket that sends to itself.
#[derive(Debug)]
pub(crate) struct ScratchPort {
    port: UdpPort,
    address: SocketAddr,
}

impl ScratchPort {
    /// Of the same kind as the simulator's address.
    pub(crate) fn open(simulator: IpAddr) -> io::Result<Self> {
        let here: IpAddr = match simulator {
            IpAddr::V4(_) => Ipv4Addr::LOCALHOST.into(),
            IpAddr::V6(_) => Ipv6Addr::LOCALHOST.into(),
        };
        let port = UdpPort::bind_to((here, 0).into())?;
        let address = port.socket().local_addr()?;
        Ok(Self { port, address })
    }

    /// Sends datagrams of `size` bytes and takes them back. One that is lost
    /// or refused makes no difference.
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
    fn what_it_sends_it_takes_back() {
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
