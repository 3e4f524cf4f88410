//! Where datagrams come from and go to.

use core::sync::atomic::{AtomicBool, Ordering};
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, SocketAddrV4, UdpSocket};

use nix::sys::socket::{setsockopt, sockopt::UdpGsoSegment};
use socket2::{Domain, Protocol, Socket, Type};

use crate::protocol::dref;
use crate::scratch_port::{PEEK_BYTES, ScratchPort};

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
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno>;

    /// Sends a datagram off, or fails at once.
    ///
    /// # Errors
    /// The operating system's error number.
    fn send(&self, datagram: &[u8], to: SocketAddr) -> Result<(), Errno>;

    /// Sends datagrams of `size` bytes that lie back to back; every one, even
    /// if another fails.
    ///
    /// # Errors
    /// The first failure's error number.
    fn send_each(&self, datagrams: &[u8], size: usize, to: SocketAddr) -> Result<(), Errno> {
        send_one_by_one(self, datagrams, size, to)
    }

    /// Loads the code and data of [`receive`](Self::receive) into the caches:
    /// takes no datagram. Does nothing by default.
    fn warm_up_receive(&self) {}

    /// Loads the code and data of [`send_each`](Self::send_each) into the
    /// caches: nothing of it leaves this port. Does nothing by default.
    fn warm_up_send(&self, _datagrams: &[u8], _size: usize) {}
}

fn send_one_by_one<P: Port + ?Sized>(
    port: &P,
    datagrams: &[u8],
    size: usize,
    to: SocketAddr,
) -> Result<(), Errno> {
    let mut outcome = Ok(());
    for datagram in datagrams.chunks(size.max(1)) {
        outcome = outcome.and(port.send(datagram, to));
    }
    outcome
}

/// The writes of a tick are cut into datagrams of this size by the kernel.
/// Nothing else that is sent here is longer.
const SEGMENT_BYTES: usize = dref::WRITE_BYTES;

/// A non-blocking UDP socket, of IPv4 or of IPv6.
///
/// Datagrams of one size go through the kernel's stack at one go where it can
/// cut them apart itself (`UDP_SEGMENT`, Linux 4.18); on the wire they are what
/// they would have been one by one.
#[derive(Debug)]
pub struct UdpPort {
    socket: UdpSocket,
    /// Whether the kernel cuts, as far as is known.
    cuts: AtomicBool,
    /// For the warm-up; `None` if the system has no other socket to give.
    scratch: Option<Box<ScratchPort>>,
}

impl UdpPort {
    /// Binds to a local port, 0 for any that is free, to send to and receive
    /// from addresses of the same kind as `peer`.
    ///
    /// # Errors
    /// When the operating system refuses, for one because the port is taken.
    pub fn bind(port: u16, peer: IpAddr) -> io::Result<Self> {
        let mut bound = Self::bind_to((any_address(peer), port).into())?;
        bound.scratch = ScratchPort::open(peer).ok().map(Box::new);
        Ok(bound)
    }

    pub(crate) fn bind_to(address: SocketAddr) -> io::Result<Self> {
        let socket = socket(Domain::for_address(address))?;
        if address.is_ipv6() {
            // IPv4 is another socket's, wherever the system's default is.
            socket.set_only_v6(true)?;
        }
        socket.bind(&address.into())?;
        socket.set_nonblocking(true)?;
        let cuts = setsockopt(&socket, UdpGsoSegment, &(SEGMENT_BYTES as i32)).is_ok();
        Ok(Self {
            socket: socket.into(),
            cuts: AtomicBool::new(cuts),
            scratch: None,
        })
    }

    /// Joins the multicast group of the beacons. Other programs on this
    /// machine may listen on the same port.
    ///
    /// # Errors
    /// When the operating system refuses.
    pub(crate) fn listen(group: SocketAddrV4) -> io::Result<Self> {
        let socket = socket(Domain::IPV4)?;
        socket.set_reuse_address(true)?;
        socket.bind(&SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, group.port()).into())?;
        if group.ip().is_multicast() {
            let outside = socket.join_multicast_v4(group.ip(), &Ipv4Addr::UNSPECIFIED);
            // A machine without a network has its own loopback to listen on.
            let inside = socket.join_multicast_v4(group.ip(), &Ipv4Addr::LOCALHOST);
            outside.or(inside)?;
        }
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket: socket.into(),
            cuts: AtomicBool::new(false),
            scratch: None,
        })
    }

    /// The port it is bound to.
    ///
    /// # Errors
    /// When the operating system refuses.
    pub fn local_port(&self) -> io::Result<u16> {
        self.socket.local_addr().map(|address| address.port())
    }

    /// The socket itself, for set-up that may wait.
    pub(crate) const fn socket(&self) -> &UdpSocket {
        &self.socket
    }
}

fn socket(domain: Domain) -> io::Result<Socket> {
    Socket::new(domain, Type::DGRAM, Some(Protocol::UDP))
}

/// To bind to, for who sends to `peer`.
pub(crate) const fn any_address(peer: IpAddr) -> IpAddr {
    match peer {
        IpAddr::V4(_) => IpAddr::V4(Ipv4Addr::UNSPECIFIED),
        IpAddr::V6(_) => IpAddr::V6(Ipv6Addr::UNSPECIFIED),
    }
}

fn errno(error: &io::Error) -> Errno {
    error.raw_os_error().unwrap_or(0)
}

impl Port for UdpPort {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno> {
        match self.socket.recv_from(into) {
            Ok(received) => Ok(Some(received)),
            Err(error) => match error.kind() {
                // Interrupted: the next tick takes it.
                io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted => Ok(None),
                _ => Err(errno(&error)),
            },
        }
    }

    fn send(&self, datagram: &[u8], to: SocketAddr) -> Result<(), Errno> {
        match self.socket.send_to(datagram, to) {
            Ok(_) => Ok(()),
            // Where the network device leaves checksums to the kernel, Linux
            // before 6.11 refuses all that a socket that cuts sends, even what
            // is too short to be cut.
            Err(error) if self.cuts.load(Ordering::Relaxed) && is_about_cutting(&error) => {
                self.stop_cutting();
                let sent = self.socket.send_to(datagram, to);
                sent.map(drop).map_err(|error| errno(&error))
            }
            Err(error) => Err(errno(&error)),
        }
    }

    fn send_each(&self, datagrams: &[u8], size: usize, to: SocketAddr) -> Result<(), Errno> {
        if size == SEGMENT_BYTES && self.cuts.load(Ordering::Relaxed) {
            match self.socket.send_to(datagrams, to) {
                Ok(_) => return Ok(()),
                // A network device or a tunnel that cannot have it cut.
                Err(error) if is_about_cutting(&error) => self.stop_cutting(),
                Err(error) => return Err(errno(&error)),
            }
        }
        send_one_by_one(self, datagrams, size, to)
    }

    fn warm_up_receive(&self) {
        // Looks at the next datagram and leaves it in the queue (`MSG_PEEK`).
        let _ = self.socket.peek_from(&mut [0; PEEK_BYTES]);
    }

    fn warm_up_send(&self, datagrams: &[u8], size: usize) {
        if let Some(scratch) = &self.scratch {
            scratch.send_to_itself(datagrams, size);
        }
    }
}

impl UdpPort {
    /// From now on datagrams are sent one by one.
    fn stop_cutting(&self) {
        self.cuts.store(false, Ordering::Relaxed);
        // Without effect on what is shorter than a segment, should it fail.
        let _ = setsockopt(&self.socket, UdpGsoSegment, &0);
    }
}

fn is_about_cutting(error: &io::Error) -> bool {
    let about = [
        nix::errno::Errno::EIO,
        nix::errno::Errno::EINVAL,
        nix::errno::Errno::EMSGSIZE,
        nix::errno::Errno::EOPNOTSUPP,
    ];
    about.iter().any(|code| *code as i32 == errno(error))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    const HERE: [IpAddr; 2] = [
        IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V6(Ipv6Addr::LOCALHOST),
    ];

    /// Four datagrams, each full of its own number, as another socket gets
    /// them.
    fn received_of_four(here: IpAddr, prepare: impl FnOnce(&UdpPort)) -> Vec<Vec<u8>> {
        let other = UdpSocket::bind((here, 0)).unwrap();
        other
            .set_read_timeout(Some(Duration::from_secs(10)))
            .unwrap();
        let address = other.local_addr().unwrap();
        let port = UdpPort::bind(0, here).unwrap();
        prepare(&port);
        let four = [1_u8, 2, 3, 4].map(|number| [number; SEGMENT_BYTES]);
        port.send_each(four.as_flattened(), SEGMENT_BYTES, address)
            .unwrap();
        port.send(b"the end", address).unwrap();
        let mut buffer = [0; 4_096];
        std::iter::from_fn(|| {
            let (length, _) = other.recv_from(&mut buffer).unwrap();
            let datagram = buffer[..length].to_vec();
            (datagram != b"the end").then_some(datagram)
        })
        .collect()
    }

    #[test]
    fn datagrams_sent_at_one_go_arrive_one_by_one() {
        let four = [1_u8, 2, 3, 4].map(|number| vec![number; 509]);
        for here in HERE {
            assert_eq!(received_of_four(here, |_| {}), four);
            assert_eq!(received_of_four(here, UdpPort::stop_cutting), four);
        }
    }

    /// Too long for UDP, refused with the same number as what cannot be cut.
    #[test]
    fn what_is_refused_is_tried_again_without_cutting() {
        let refused = |port: &UdpPort| {
            let nobody = (Ipv4Addr::LOCALHOST, 9).into();
            let sent = port.send(&vec![0; 70_000], nobody);
            assert_eq!(sent, Err(nix::errno::Errno::EMSGSIZE as i32));
            assert!(!port.cuts.load(Ordering::Relaxed));
        };
        let four = [1_u8, 2, 3, 4].map(|number| vec![number; 509]);
        assert_eq!(received_of_four(HERE[0], refused), four);
    }
}
