//! Sending and receiving datagrams by UDP.

use core::sync::atomic::{AtomicBool, Ordering};
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, SocketAddrV4, UdpSocket};

use nix::sys::socket::{setsockopt, sockopt::UdpGsoSegment};
use socket2::{Domain, Protocol, Socket, Type};

use crate::port::{Errno, Port, send_one_by_one};
use crate::protocol::dref;
use crate::source_filter::{self, SourceFilter};

/// Longer than what X-Plane sends.
const PEEK_BYTES: usize = 2_048;
/// More than are sent in a tick. Any remaining datagrams of a warm-up are
/// received by the next.
const MOST_RECEIVED: usize = 16;
/// The size of the datagrams into which the kernel segments the writes of a
/// tick. Nothing longer is sent here.
const SEGMENT_BYTES: usize = dref::WRITE_BYTES;

/// A non-blocking UDP socket, of IPv4 or of IPv6.
///
/// Datagrams of one size pass through the kernel's network stack together where
/// it can segment them itself (`UDP_SEGMENT`, Linux 4.18); on the wire they are
/// the same as if sent one by one.
#[derive(Debug)]
pub struct UdpPort {
    socket: UdpSocket,
    /// Whether the kernel segments, as far as is known.
    segments: AtomicBool,
    /// A socket on the loopback interface that sends to itself, at its address,
    /// for the warm-up; `None` if no further socket could be opened.
    scratch: Option<(Box<Self>, SocketAddr)>,
}

impl UdpPort {
    /// Binds to a local port, 0 for any that is free, to send to and receive
    /// from `peer`: what comes from other addresses the kernel does not deliver,
    /// unless `peer` is unspecified. If it is a loopback address, other machines
    /// cannot send here.
    ///
    /// # Errors
    /// When the operating system refuses, for example because the port is
    /// taken.
    pub fn bind(port: u16, peer: IpAddr) -> io::Result<Self> {
        let mut bound = Self::bind_to((local_address(peer), port).into())?;
        if !peer.is_unspecified() {
            // If this fails, the sensor leaves out what others send.
            let _ = source_filter::attach(&bound.socket, peer, None);
        }
        bound.scratch = Self::open_scratch(peer).ok();
        Ok(bound)
    }

    fn bind_to(address: SocketAddr) -> io::Result<Self> {
        let socket = socket(Domain::for_address(address))?;
        if address.is_ipv6() {
            // Not for IPv4, whatever the system's default is.
            socket.set_only_v6(true)?;
        }
        socket.bind(&address.into())?;
        socket.set_nonblocking(true)?;
        let segments = setsockopt(&socket, UdpGsoSegment, &(SEGMENT_BYTES as i32)).is_ok();
        Ok(Self {
            socket: socket.into(),
            segments: AtomicBool::new(segments),
            scratch: None,
        })
    }

    /// After 25 ms of sleep the kernel's datagram path is in no cache either, and
    /// on the simulator's socket it cannot be run in advance without sending. So
    /// this one makes the same system calls without effect.
    fn open_scratch(peer: IpAddr) -> io::Result<(Box<Self>, SocketAddr)> {
        let port = Self::bind_to((loopback_address(peer), 0).into())?;
        let address = port.socket.local_addr()?;
        // What others send would be received in place of its own.
        source_filter::attach(&port.socket, address.ip(), Some(&[address.port()]))?;
        Ok((Box::new(port), address))
    }

    /// Joins the multicast group of the beacons. Other programs on this
    /// machine may listen on the same port. Bound to the group, so the port may be
    /// that of another program on an address of this machine: it lies within Linux'
    /// range of automatic ports.
    ///
    /// # Errors
    /// When the operating system refuses.
    pub(crate) fn listen(group: SocketAddrV4) -> io::Result<Self> {
        let socket = socket(Domain::IPV4)?;
        socket.set_reuse_address(true)?;
        socket.bind(&group.into())?;
        if group.ip().is_multicast() {
            let outside = socket.join_multicast_v4(group.ip(), &Ipv4Addr::UNSPECIFIED);
            // A machine without a network can still receive on its loopback
            // interface.
            let inside = socket.join_multicast_v4(group.ip(), &Ipv4Addr::LOCALHOST);
            outside.or(inside)?;
        }
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket: socket.into(),
            segments: AtomicBool::new(false),
            scratch: None,
        })
    }

    /// The local port.
    ///
    /// # Errors
    /// When the operating system refuses.
    pub fn local_port(&self) -> io::Result<u16> {
        self.socket.local_addr().map(|address| address.port())
    }

    /// The filter of what is received.
    pub(crate) fn filter(&self) -> io::Result<SourceFilter> {
        SourceFilter::of(&self.socket)
    }

    /// The socket, for set-up that may wait.
    pub(crate) const fn socket(&self) -> &UdpSocket {
        &self.socket
    }
}

fn socket(domain: Domain) -> io::Result<Socket> {
    Socket::new(domain, Type::DGRAM, Some(Protocol::UDP))
}

/// The address to bind to for datagrams of `peer`: only this machine can send to
/// a loopback address.
pub(crate) const fn local_address(peer: IpAddr) -> IpAddr {
    match peer {
        _ if peer.is_loopback() => loopback_address(peer),
        IpAddr::V4(_) => IpAddr::V4(Ipv4Addr::UNSPECIFIED),
        IpAddr::V6(_) => IpAddr::V6(Ipv6Addr::UNSPECIFIED),
    }
}

const fn loopback_address(peer: IpAddr) -> IpAddr {
    match peer {
        IpAddr::V4(_) => IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V6(_) => IpAddr::V6(Ipv6Addr::LOCALHOST),
    }
}

/// The kernel binds a socket only to addresses of this machine.
pub(crate) fn is_of_this_machine(mut address: SocketAddr) -> bool {
    address.set_port(0);
    UdpSocket::bind(address).is_ok()
}

fn errno(error: &io::Error) -> Errno {
    error.raw_os_error().unwrap_or(0)
}

impl Port for UdpPort {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno> {
        match self.socket.recv_from(into) {
            Ok(received) => Ok(Some(received)),
            Err(error) => match error.kind() {
                // Interrupted: the next tick receives it.
                io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted => Ok(None),
                _ => Err(errno(&error)),
            },
        }
    }

    fn send(&self, datagram: &[u8], to: SocketAddr) -> Result<(), Errno> {
        match self.socket.send_to(datagram, to) {
            Ok(_) => Ok(()),
            // Where the network device leaves checksums to the kernel, Linux
            // before 6.11 refuses everything that a segmenting socket sends,
            // even datagrams too short to be segmented.
            Err(error)
                if self.segments.load(Ordering::Relaxed) && is_about_segmentation(&error) =>
            {
                self.stop_segmenting();
                let sent = self.socket.send_to(datagram, to);
                sent.map(drop).map_err(|error| errno(&error))
            }
            Err(error) => Err(errno(&error)),
        }
    }

    fn send_each(&self, datagrams: &[u8], size: usize, to: SocketAddr) -> Result<(), Errno> {
        if size == SEGMENT_BYTES && self.segments.load(Ordering::Relaxed) {
            match self.socket.send_to(datagrams, to) {
                Ok(_) => return Ok(()),
                // A network device or tunnel that does not support
                // segmentation.
                Err(error) if is_about_segmentation(&error) => self.stop_segmenting(),
                Err(error) => return Err(errno(&error)),
            }
        }
        send_one_by_one(self, datagrams, size, to)
    }

    fn warm_up_receive(&self) {
        // Reads the next datagram without removing it from the queue
        // (`MSG_PEEK`).
        let _ = self.socket.peek_from(&mut [0; PEEK_BYTES]);
    }

    fn warm_up_send(&self, datagrams: &[u8], size: usize) {
        let Some((scratch, address)) = &self.scratch else {
            return;
        };
        // A lost or refused datagram has no effect.
        let _ = scratch.send_each(datagrams, size, *address);
        let mut taken = [0; PEEK_BYTES];
        for _ in 0..MOST_RECEIVED {
            if !matches!(scratch.receive(&mut taken), Ok(Some(_))) {
                break;
            }
        }
    }
}

impl UdpPort {
    /// From now on datagrams are sent one by one.
    fn stop_segmenting(&self) {
        self.segments.store(false, Ordering::Relaxed);
        // If this fails, datagrams shorter than a segment are not affected.
        let _ = setsockopt(&self.socket, UdpGsoSegment, &0);
    }
}

fn is_about_segmentation(error: &io::Error) -> bool {
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

    #[test]
    fn beacons_arrive_whoever_has_their_port_on_an_address_of_this_machine() {
        let other = UdpSocket::bind("127.0.0.1:0").unwrap();
        let port = other.local_addr().unwrap().port();
        let group = SocketAddrV4::new(Ipv4Addr::new(239, 255, 1, 1), port);
        let listens = UdpPort::listen(group).unwrap();
        socket2::SockRef::from(&other)
            .set_multicast_if_v4(&Ipv4Addr::LOCALHOST)
            .unwrap();
        other.send_to(b"to the group", group).unwrap();
        other.send_to(b"to one", ("127.0.0.1", port)).unwrap();
        let socket = listens.socket();
        socket.set_nonblocking(false).unwrap();
        socket
            .set_read_timeout(Some(Duration::from_millis(500)))
            .unwrap();
        let mut buffer = [0; 16];
        assert_eq!(socket.recv(&mut buffer).unwrap(), 12);
        assert!(socket.recv(&mut buffer).is_err());
    }

    /// Four datagrams, each filled with its number, as another socket receives
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
    fn datagrams_sent_together_arrive_one_by_one() {
        let four = [1_u8, 2, 3, 4].map(|number| vec![number; 509]);
        for here in HERE {
            assert_eq!(received_of_four(here, |_| {}), four);
            assert_eq!(received_of_four(here, UdpPort::stop_segmenting), four);
        }
    }

    #[test]
    fn of_a_simulator_on_this_machine_only_this_machine_reaches_the_port() {
        for simulator in HERE {
            let port = UdpPort::bind(0, simulator).unwrap();
            assert_eq!(port.socket.local_addr().unwrap().ip(), simulator);
        }
        let elsewhere = UdpPort::bind(0, [192, 0, 2, 1].into()).unwrap();
        assert!(elsewhere.socket.local_addr().unwrap().ip().is_unspecified());
    }

    #[test]
    fn the_warm_up_receives_everything_that_it_sends() {
        for simulator in HERE {
            let port = UdpPort::bind(0, simulator).unwrap();
            let (scratch, _) = port.scratch.as_ref().unwrap();
            for _ in 0..3 {
                port.warm_up_send(&[7; 4 * SEGMENT_BYTES], SEGMENT_BYTES);
                assert_eq!(scratch.receive(&mut [0; PEEK_BYTES]), Ok(None));
            }
        }
    }

    /// Too long for UDP, refused with the same error number as when
    /// segmentation is not possible.
    #[test]
    fn a_refused_send_is_repeated_without_segmentation() {
        let refused = |port: &UdpPort| {
            let unused = (Ipv4Addr::LOCALHOST, 9).into();
            let sent = port.send(&vec![0; 70_000], unused);
            assert_eq!(sent, Err(nix::errno::Errno::EMSGSIZE as i32));
            assert!(!port.segments.load(Ordering::Relaxed));
        };
        let four = [1_u8, 2, 3, 4].map(|number| vec![number; 509]);
        assert_eq!(received_of_four(HERE[0], refused), four);
    }
}
