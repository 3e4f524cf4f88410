//! What the simulator's machine reports about one of its ports.
//!
//! A request without effect is sent from a socket that is connected to the port:
//! for such a socket the kernel keeps what is reported about its datagrams (ICMP),
//! with the address of who reports it (`IP_RECVERR`, ip(7)). Any machine may send
//! such a report, and the kernel only compares the header that it quotes. So that
//! a port is closed counts only from the machine that has the port.

use std::io::{ErrorKind, IoSliceMut};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::os::fd::AsRawFd as _;

use nix::libc::sock_extended_err;
use nix::sys::socket::sockopt::{Ipv4RecvErr, Ipv6RecvErr};
use nix::sys::socket::{ControlMessageOwned, MsgFlags, recvmsg, setsockopt};

use crate::protocol::rref;
use crate::udp_port::local_address;

/// More than the kernel keeps of a socket with its usual receive buffer.
const MOST_REPORTS: usize = 1_000;

/// Of the request, distinct from those of sensors and of a release.
const INDEX: i32 = 9_004;

/// A socket that is connected to a port of the simulator's machine.
#[derive(Debug)]
pub(crate) struct Probe {
    to: IpAddr,
    socket: UdpSocket,
    request: [u8; rref::REQUEST_BYTES],
}

/// What is reported.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Report {
    /// By the port's machine: no program has it.
    Closed,
    /// By any machine, with this number: no route leads there.
    Unreachable(i32),
}

/// The number of an error that says that nothing leads to a machine: no route, no
/// network, or what this machine forbids to send.
pub(crate) fn unreachable(error: &std::io::Error) -> Option<i32> {
    let is_it = matches!(
        error.kind(),
        ErrorKind::HostUnreachable
            | ErrorKind::NetworkUnreachable
            | ErrorKind::NetworkDown
            | ErrorKind::PermissionDenied
    );
    error.raw_os_error().filter(|_| is_it)
}

impl Probe {
    /// # Errors
    /// When no socket can be opened, or none that is told what is reported.
    pub(crate) fn of(to: SocketAddr) -> std::io::Result<Self> {
        let socket = UdpSocket::bind((local_address(to.ip()), 0))?;
        socket.set_nonblocking(true)?;
        match to {
            SocketAddr::V4(_) => setsockopt(&socket, Ipv4RecvErr, &true)?,
            SocketAddr::V6(_) => setsockopt(&socket, Ipv6RecvErr, &true)?,
        }
        socket.connect(to)?;
        let mut request = [0; rref::REQUEST_BYTES];
        // It ends what was not requested. The path is a valid one.
        let _ = rref::request(&mut request, 0, INDEX, "sim/time/paused");
        Ok(Self {
            to: to.ip(),
            socket,
            request,
        })
    }

    /// Sends the request, unless a report is there that was not read: then the
    /// kernel returns that error instead.
    /// The number of what prevents that it is sent.
    pub(crate) fn send(&self) -> Option<i32> {
        unreachable(&self.socket.send(&self.request).err()?)
    }

    /// The last thing that was reported since the last call.
    pub(crate) fn reported(&self) -> Option<Report> {
        let mut last = None;
        for _ in 0..MOST_REPORTS {
            let Some((error, by)) = self.next_report() else {
                break;
            };
            let error = std::io::Error::from_raw_os_error(error.cast_signed());
            let report = match error.kind() {
                ErrorKind::ConnectionRefused if by == Some(self.to) => Some(Report::Closed),
                _ => unreachable(&error).map(Report::Unreachable),
            };
            last = report.or(last);
        }
        last
    }

    /// Whether the port was reported as closed since the last call.
    pub(crate) fn is_refused(&self) -> bool {
        self.reported() == Some(Report::Closed)
    }

    /// The number of an error, and who reported it.
    fn next_report(&self) -> Option<(u32, Option<IpAddr>)> {
        let mut quoted = [0; rref::REQUEST_BYTES];
        let mut into = [IoSliceMut::new(&mut quoted)];
        let mut space = nix::cmsg_space!(sock_extended_err, nix::libc::sockaddr_in6);
        let flags = MsgFlags::MSG_ERRQUEUE | MsgFlags::MSG_DONTWAIT;
        let received = recvmsg::<()>(self.socket.as_raw_fd(), &mut into, Some(&mut space), flags);
        received
            .ok()?
            .cmsgs()
            .ok()?
            .find_map(|message| match message {
                ControlMessageOwned::Ipv4RecvErr(error, by) => {
                    let by = by.map(|by| Ipv4Addr::from(by.sin_addr.s_addr.to_ne_bytes()).into());
                    Some((error.ee_errno, by))
                }
                ControlMessageOwned::Ipv6RecvErr(error, by) => {
                    let by = by.map(|by| Ipv6Addr::from(by.sin6_addr.s6_addr).into());
                    Some((error.ee_errno, by))
                }
                _ => None,
            })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_closed_port_is_reported_by_its_machine() {
        for host in ["127.0.0.1", "[::1]"] {
            let open = UdpSocket::bind(format!("{host}:0")).unwrap();
            let at = open.local_addr().unwrap();
            let probe = Probe::of(at).unwrap();
            let asked = || {
                probe.send();
                std::thread::sleep(Duration::from_millis(20));
                probe.reported()
            };
            assert_eq!(asked(), None, "{host}");
            drop(open);
            assert_eq!(asked(), Some(Report::Closed), "{host}");
            assert_eq!(asked(), Some(Report::Closed), "{host}");
        }
    }

    /// A report by another machine: here of a loopback address that is not the
    /// port's.
    #[test]
    fn a_report_by_another_machine_does_not_count() {
        let open = UdpSocket::bind("127.0.0.1:0").unwrap();
        let at = open.local_addr().unwrap();
        drop(open);
        let mut probe = Probe::of(at).unwrap();
        probe.to = [127, 0, 0, 9].into();
        probe.send();
        std::thread::sleep(Duration::from_millis(20));
        assert_eq!(probe.reported(), None);
    }
}
