//! Where datagrams come from and go to.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};

use socket2::{Domain, Protocol, Socket, Type};

/// An operating system's error number, 0 if it gave none.
pub type Errno = i32;

/// Sends and receives datagrams without ever waiting. [`UdpPort`] is the real
/// one; tests and fuzzing bring their own.
pub trait Port: Send + Sync {
    /// Takes the next datagram, its length and sender; `None` if there is none
    /// now. What does not fit the buffer is cut off.
    ///
    /// # Errors
    /// The operating system's error number.
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddrV4)>, Errno>;

    /// Sends a datagram off, or fails at once.
    ///
    /// # Errors
    /// The operating system's error number.
    fn send(&self, datagram: &[u8], to: SocketAddrV4) -> Result<(), Errno>;
}

/// A non-blocking IPv4 UDP socket.
#[derive(Debug)]
pub struct UdpPort(UdpSocket);

impl UdpPort {
    /// Binds to a local port, 0 for any that is free.
    ///
    /// # Errors
    /// When the operating system refuses, for one because the port is taken.
    pub fn bind(port: u16) -> io::Result<Self> {
        let socket = socket()?;
        socket.bind(&SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, port).into())?;
        socket.set_nonblocking(true)?;
        Ok(Self(socket.into()))
    }

    /// Joins the multicast group of the beacons. Other programs on this
    /// machine may listen on the same port.
    ///
    /// # Errors
    /// When the operating system refuses.
    pub(crate) fn listen(group: SocketAddrV4) -> io::Result<Self> {
        let socket = socket()?;
        socket.set_reuse_address(true)?;
        socket.bind(&SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, group.port()).into())?;
        if group.ip().is_multicast() {
            let outside = socket.join_multicast_v4(group.ip(), &Ipv4Addr::UNSPECIFIED);
            // A machine without a network has its own loopback to listen on.
            let inside = socket.join_multicast_v4(group.ip(), &Ipv4Addr::LOCALHOST);
            outside.or(inside)?;
        }
        socket.set_nonblocking(true)?;
        Ok(Self(socket.into()))
    }

    /// The port it is bound to.
    ///
    /// # Errors
    /// When the operating system refuses.
    pub fn local_port(&self) -> io::Result<u16> {
        self.0.local_addr().map(|address| address.port())
    }

    /// The socket itself, for set-up that may wait.
    pub(crate) const fn socket(&self) -> &UdpSocket {
        &self.0
    }
}

fn socket() -> io::Result<Socket> {
    Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))
}

fn errno(error: &io::Error) -> Errno {
    error.raw_os_error().unwrap_or(0)
}

impl Port for UdpPort {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddrV4)>, Errno> {
        match self.0.recv_from(into) {
            Ok((length, SocketAddr::V4(from))) => Ok(Some((length, from))),
            // An IPv4 socket has no other senders.
            Ok((_, SocketAddr::V6(_))) => Ok(None),
            Err(error) => match error.kind() {
                // Interrupted: the next tick takes it.
                io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted => Ok(None),
                _ => Err(errno(&error)),
            },
        }
    }

    fn send(&self, datagram: &[u8], to: SocketAddrV4) -> Result<(), Errno> {
        match self.0.send_to(datagram, to) {
            Ok(_) => Ok(()),
            Err(error) => Err(errno(&error)),
        }
    }
}
