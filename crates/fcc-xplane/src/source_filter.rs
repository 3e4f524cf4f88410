//! The kernel delivers only what the simulator sends.
//!
//! A socket receives from anywhere, into one buffer: datagrams of others fill
//! it, and what the simulator sends is lost. So a filter in the kernel (classic
//! BPF, `SO_ATTACH_FILTER`, socket(7)) drops them before they are queued: by the
//! sender's address, and by its port once that is known. A connected socket
//! would do the same, but of one port only, and X-Plane answers from another
//! than the one that it listens on.
//!
//! The filter is attached when a connection is opened, and adapted by the thread
//! that reports on the connection: never in a tick.

use std::io::{self, Read as _};
use std::net::IpAddr;
use std::os::fd::AsFd;
use std::sync::{Mutex, PoisonError};

use socket2::{SockFilter, SockRef, Socket};

// Codes of instructions (linux/bpf_common.h), which libc does not have for Android.
const BPF_LD: u32 = 0x00;
const BPF_JMP: u32 = 0x05;
const BPF_RET: u32 = 0x06;
const BPF_W: u32 = 0x00;
const BPF_H: u32 = 0x08;
const BPF_ABS: u32 = 0x20;
const BPF_JEQ: u32 = 0x10;
const BPF_K: u32 = 0x00;

/// Offsets from here on count from the network header, others from UDP's
/// (linux/filter.h).
const NETWORK_HEADER: u32 = (-0x0010_0000_i32).cast_unsigned();
/// Where the sender's address is in the header (RFC 791, RFC 8200).
const IPV4_SOURCE: u32 = 12;
const IPV6_SOURCE: u32 = 8;
/// Where the sender's port is in UDP's header (RFC 768).
const SOURCE_PORT: u32 = 0;
/// The whole datagram.
const ALL_BYTES: u32 = u32::MAX;

/// The sender's ports that are delivered; 0 for none. If all are 0, every port
/// is.
pub(crate) type Ports = [u16; 4];

/// From where datagrams are delivered.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Source {
    ip: IpAddr,
    /// None for every port.
    ports: Option<Vec<u16>>,
}

/// The filter of a connection's socket.
#[derive(Debug)]
pub(crate) struct SourceFilter {
    socket: Socket,
    attached: Mutex<Option<Source>>,
}

/// More than wait in a socket at Linux's default size; of a larger one some are left.
const MOST_QUEUED: usize = 2_000;

impl SourceFilter {
    /// For the socket with this descriptor, which is duplicated.
    pub(crate) fn of(socket: &impl AsFd) -> io::Result<Self> {
        Ok(Self {
            socket: SockRef::from(socket).try_clone()?,
            attached: Mutex::new(None),
        })
    }

    /// Follows what is known about the simulator: its address, the ports to deliver from, and
    /// `owned`, the ports that are the simulator's user's, if that is known. Without a filter
    /// the sensor still leaves out what others send, as long as the socket's buffer does
    /// not overflow; so a failure is none of the connection.
    pub(crate) fn follow(&self, ip: IpAddr, delivered: Ports, owned: Option<&[u16]>) {
        let wanted = Source {
            ip,
            ports: permitted(delivered, owned),
        };
        let mut attached = self.attached.lock().unwrap_or_else(PoisonError::into_inner);
        if attached.as_ref() != Some(&wanted)
            && attach(&self.socket, wanted.ip, wanted.ports.as_deref()).is_ok()
        {
            if attached.is_none() && wanted.ports.is_some() {
                self.drop_queued();
            }
            *attached = Some(wanted);
        }
    }

    /// What came before there was a filter came from anybody.
    fn drop_queued(&self) {
        let mut datagram = [0; 1];
        for _ in 0..MOST_QUEUED {
            if (&self.socket).read(&mut datagram).is_err() {
                break;
            }
        }
    }
}

/// The ports to deliver from; none if from every port. If none of those that are
/// known is the user's, another one of the user's may answer.
fn permitted(known: Ports, owned: Option<&[u16]>) -> Option<Vec<u16>> {
    let is_owned = |port: &u16| owned.is_none_or(|owned| owned.contains(port));
    let known = known.into_iter().filter(|port| *port != 0);
    let known: Vec<u16> = known.filter(is_owned).collect();
    if known.is_empty() {
        owned.map(<[u16]>::to_vec)
    } else {
        Some(known)
    }
}

/// From now on the kernel delivers to this UDP socket only what comes from this
/// address and, if they are given, these ports. What is queued already stays.
///
/// # Errors
/// When the operating system refuses.
pub(crate) fn attach(socket: &impl AsFd, ip: IpAddr, ports: Option<&[u16]>) -> io::Result<()> {
    SockRef::from(socket).attach_filter(&program(ip, ports))
}

/// A comparison of the value loaded last; `then` and `otherwise` are the numbers
/// of instructions to leave out.
const fn compare(with: u32, then: u8, otherwise: u8) -> SockFilter {
    SockFilter::new((BPF_JMP | BPF_JEQ | BPF_K) as u16, then, otherwise, with)
}

const fn load(width: u32, offset: u32) -> SockFilter {
    SockFilter::new((BPF_LD | BPF_ABS | width) as u16, 0, 0, offset)
}

const fn deliver(bytes: u32) -> SockFilter {
    SockFilter::new((BPF_RET | BPF_K) as u16, 0, 0, bytes)
}

fn program(ip: IpAddr, ports: Option<&[u16]>) -> Vec<SockFilter> {
    let (offset, words) = match ip {
        IpAddr::V4(ip) => (IPV4_SOURCE, vec![ip.to_bits()]),
        IpAddr::V6(ip) => {
            let bits = ip.to_bits();
            let words = [96, 64, 32, 0].map(|shift| (bits >> shift) as u32);
            (IPV6_SOURCE, words.to_vec())
        }
    };
    let mut program = Vec::new();
    for (word, at) in words.into_iter().zip((offset..).step_by(4)) {
        program.extend([
            load(BPF_W, NETWORK_HEADER + at),
            compare(word, 1, 0),
            deliver(0),
        ]);
    }
    if let Some(ports) = ports {
        program.push(load(BPF_H, SOURCE_PORT));
        for port in ports {
            program.extend([compare((*port).into(), 0, 1), deliver(ALL_BYTES)]);
        }
        program.push(deliver(0));
    }
    program.push(deliver(ALL_BYTES));
    program
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;

    use super::*;

    /// The datagrams that a socket receives of those that each of these sends.
    fn received(receiver: &UdpSocket, senders: &[&UdpSocket]) -> Vec<u8> {
        let to = receiver.local_addr().unwrap();
        for (number, sender) in (0..).zip(senders) {
            sender.send_to(&[number], to).unwrap();
        }
        receiver.set_nonblocking(true).unwrap();
        let mut byte = [0];
        std::iter::from_fn(|| receiver.recv(&mut byte).ok().map(|_| byte[0])).collect()
    }

    #[test]
    fn only_the_simulators_address_and_ports_are_delivered() {
        let bind = |ip| UdpSocket::bind((ip, 0)).unwrap();
        let port = |socket: &UdpSocket| socket.local_addr().unwrap().port();
        let receiver = bind("127.0.0.1");
        let [first, second, third, other] =
            ["127.0.0.2", "127.0.0.2", "127.0.0.2", "127.0.0.3"].map(bind);
        let senders = [&first, &second, &third, &other];
        assert_eq!(received(&receiver, &senders), [0, 1, 2, 3]);
        let there = "127.0.0.2".parse().unwrap();
        attach(&receiver, there, None).unwrap();
        assert_eq!(received(&receiver, &senders), [0, 1, 2]);
        attach(&receiver, there, Some(&[port(&first), port(&third)])).unwrap();
        assert_eq!(received(&receiver, &senders), [0, 2]);
        attach(&receiver, there, Some(&[port(&other)])).unwrap();
        assert_eq!(received(&receiver, &senders), []);
        attach(&receiver, "127.0.0.3".parse().unwrap(), None).unwrap();
        assert_eq!(received(&receiver, &senders), [3]);
        attach(&receiver, there, Some(&[])).unwrap();
        assert_eq!(received(&receiver, &senders), []);
    }

    #[test]
    fn only_ports_of_the_simulators_user_are_delivered() {
        assert_eq!(permitted([0; 4], None), None);
        assert_eq!(permitted([5, 0, 0, 7], None), Some(vec![5, 7]));
        assert_eq!(permitted([0; 4], Some(&[7, 8])), Some(vec![7, 8]));
        assert_eq!(permitted([5, 0, 0, 7], Some(&[7, 8])), Some(vec![7]));
        // The one that was known is another user's now.
        assert_eq!(permitted([5; 4], Some(&[7, 8])), Some(vec![7, 8]));
    }

    /// A program that sends before the daemon starts was taken for the
    /// simulator.
    #[test]
    fn what_came_before_the_simulators_user_was_known_is_dropped() {
        let [receiver, simulator, other] =
            [(); 3].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
        receiver.set_nonblocking(true).unwrap();
        let filter = SourceFilter::of(&receiver).unwrap();
        let at = simulator.local_addr().unwrap();
        let to = receiver.local_addr().unwrap();
        for _ in 0..100 {
            other.send_to(&[9], to).unwrap();
        }
        let owned = [at.port()];
        filter.follow(at.ip(), [0; 4], Some(&owned));
        assert_eq!(received(&receiver, &[&other, &simulator]), [1]);
        // Later only what is not permitted is dropped.
        simulator.send_to(&[7], to).unwrap();
        filter.follow(at.ip(), [0; 4], None);
        filter.follow(at.ip(), [0; 4], Some(&owned));
        assert_eq!(received(&receiver, &[]), [7]);
    }

    #[test]
    fn as_many_ports_as_a_user_may_have_are_delivered() {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
        let mut ports: Vec<u16> = (1..200).collect();
        ports.push(sender.local_addr().unwrap().port());
        attach(&receiver, "127.0.0.1".parse().unwrap(), Some(&ports)).unwrap();
        assert_eq!(received(&receiver, &[&sender]), [0]);
    }

    #[test]
    fn the_same_by_ipv6() {
        let bind = || UdpSocket::bind("[::1]:0").unwrap();
        let (receiver, first, second) = (bind(), bind(), bind());
        let port = first.local_addr().unwrap().port();
        attach(&receiver, "::1".parse().unwrap(), Some(&[port])).unwrap();
        assert_eq!(received(&receiver, &[&first, &second]), [0]);
        for other in ["2001:db8::1", "::2", "1::1", "::1:0:1"] {
            attach(&receiver, other.parse().unwrap(), None).unwrap();
            assert_eq!(received(&receiver, &[&first]), [], "{other}");
        }
    }
}
