//! Whose one UDP socket of this machine is, asked of the kernel by the socket's
//! address (`NETLINK_SOCK_DIAG`, `sock_diag(7)`).
//!
//! The answer concerns that socket alone: how many others there are, and that
//! some are opened and closed meanwhile, does not matter, as it does for a list.

use std::io;
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::os::fd::{AsRawFd as _, OwnedFd};

use nix::errno::Errno;
use nix::sys::socket::{AddressFamily, MsgFlags, SockFlag, SockProtocol, SockType};
use nix::sys::socket::{recv, send, socket};

/// The type of a request and of its answer, and that of an error
/// (`linux/sock_diag.h`, `linux/netlink.h`).
const BY_FAMILY: u16 = 20;
const ERROR: u16 = 2;
/// A request (linux/netlink.h).
const REQUEST: u16 = 1;
const HEADER_BYTES: usize = 16;
const REQUEST_BYTES: usize = HEADER_BYTES + 56;
/// Where the number of the user is in an answer (`idiag_uid` of struct
/// `inet_diag_msg`, `linux/inet_diag.h`).
const USER: usize = HEADER_BYTES + 64;
/// Longer than an answer with its attributes.
const ANSWER_BYTES: usize = 1_024;
/// Answers to earlier requests that are left out.
const EARLIER: usize = 4;

/// A connection to the kernel for such questions.
#[derive(Debug)]
pub(crate) struct SocketDiagnosis {
    socket: OwnedFd,
    sequence: u32,
}

impl SocketDiagnosis {
    /// # Errors
    /// When the kernel does not answer them, or this program may not ask.
    pub(crate) fn open() -> io::Result<Self> {
        let socket = socket(
            AddressFamily::Netlink,
            SockType::Datagram,
            SockFlag::SOCK_CLOEXEC | SockFlag::SOCK_NONBLOCK,
            SockProtocol::NetlinkSockDiag,
        )?;
        let mut opened = Self {
            socket,
            sequence: 0,
        };
        // A kernel without it for UDP has the same answer as for a port that is closed.
        let known = UdpSocket::bind(("127.0.0.1", 0))?;
        match opened.user_of(known.local_addr()?)? {
            Some(_) => Ok(opened),
            None => Err(io::ErrorKind::Unsupported.into()),
        }
    }

    /// The user of the socket that receives what is sent to an address; none if
    /// there is no such socket, or only one that is connected to another address.
    ///
    /// # Errors
    /// When the kernel does not tell.
    pub(crate) fn user_of(&mut self, at: SocketAddr) -> io::Result<Option<u32>> {
        self.sequence = self.sequence.wrapping_add(1);
        send(
            self.socket.as_raw_fd(),
            &request(at, self.sequence),
            MsgFlags::empty(),
        )?;
        for _ in 0..=EARLIER {
            let mut answer = [0; ANSWER_BYTES];
            let length = recv(self.socket.as_raw_fd(), &mut answer, MsgFlags::empty())?;
            let answer = answer.get(..length).unwrap_or_default();
            if word(answer, 8) == Some(self.sequence) {
                return user_in(answer);
            }
        }
        Err(io::ErrorKind::InvalidData.into())
    }
}

/// The user in an answer (struct `nlmsghdr`, then `inet_diag_msg` or an error).
fn user_in(answer: &[u8]) -> io::Result<Option<u32>> {
    let kind = answer
        .get(4..6)
        .and_then(|bytes| Some(u16::from_ne_bytes(bytes.try_into().ok()?)));
    let malformed = || io::Error::from(io::ErrorKind::InvalidData);
    match kind {
        Some(BY_FAMILY) => word(answer, USER).map(Some).ok_or_else(malformed),
        Some(ERROR) => {
            let error = word(answer, HEADER_BYTES).ok_or_else(malformed)?;
            match Errno::from_raw(error.cast_signed().wrapping_neg()) {
                Errno::ENOENT => Ok(None),
                error => Err(error.into()),
            }
        }
        _ => Err(malformed()),
    }
}

fn word(answer: &[u8], at: usize) -> Option<u32> {
    let bytes = answer.get(at..)?.first_chunk()?;
    Some(u32::from_ne_bytes(*bytes))
}

/// Struct `nlmsghdr`, then struct `inet_diag_req_v2` (`linux/inet_diag.h`). The
/// kernel looks for the socket to which a datagram from `src` to `dst` would be
/// delivered.
fn request(at: SocketAddr, sequence: u32) -> Vec<u8> {
    let (family, address) = match at.ip() {
        IpAddr::V4(ip) => {
            let mut padded = [0; 16];
            padded[..4].copy_from_slice(&ip.octets());
            (AddressFamily::Inet, padded)
        }
        IpAddr::V6(ip) => (AddressFamily::Inet6, ip.octets()),
    };
    let mut request = Vec::with_capacity(REQUEST_BYTES);
    request.extend((REQUEST_BYTES as u32).to_ne_bytes());
    request.extend(BY_FAMILY.to_ne_bytes());
    request.extend(REQUEST.to_ne_bytes());
    request.extend(sequence.to_ne_bytes());
    // The sender's number: the kernel fills it in.
    request.extend(0_u32.to_ne_bytes());
    request.extend([family as u8, nix::libc::IPPROTO_UDP as u8, 0, 0]);
    // In any state.
    request.extend(u32::MAX.to_ne_bytes());
    request.extend(0_u16.to_be_bytes());
    request.extend(at.port().to_be_bytes());
    request.extend(address);
    request.extend(address);
    // At any interface, and whatever its cookie is (INET_DIAG_NOCOOKIE).
    request.extend(0_u32.to_ne_bytes());
    request.extend([0xFF; 8]);
    request
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::MetadataExt;

    use super::*;

    #[test]
    fn the_kernel_tells_whose_a_socket_is_until_it_is_closed() {
        let mut kernel = SocketDiagnosis::open().unwrap();
        let own = std::fs::metadata("/proc/self").unwrap().uid();
        for (bound, at) in [
            ("127.0.0.1", "127.0.0.1"),
            ("0.0.0.0", "127.0.0.1"),
            ("[::1]", "[::1]"),
            ("[::]", "127.0.0.1"),
        ] {
            let socket = UdpSocket::bind(format!("{bound}:0")).unwrap();
            let port = socket.local_addr().unwrap().port();
            let at: SocketAddr = format!("{at}:{port}").parse().unwrap();
            assert_eq!(kernel.user_of(at).unwrap(), Some(own), "{bound}");
            drop(socket);
            assert_eq!(kernel.user_of(at).unwrap(), None, "{bound}");
        }
    }

    #[test]
    fn an_answer_that_is_cut_off_is_an_error() {
        let mut answer = vec![0; USER + 4];
        answer[4..6].copy_from_slice(&BY_FAMILY.to_ne_bytes());
        answer[USER..].copy_from_slice(&1000_u32.to_ne_bytes());
        assert_eq!(user_in(&answer).unwrap(), Some(1000));
        for length in 0..answer.len() {
            assert!(user_in(&answer[..length]).is_err(), "{length}");
        }
        answer[4..6].copy_from_slice(&ERROR.to_ne_bytes());
        answer[HEADER_BYTES..HEADER_BYTES + 4].copy_from_slice(&(-2_i32).to_ne_bytes());
        assert_eq!(user_in(&answer).unwrap(), None);
        answer[HEADER_BYTES..HEADER_BYTES + 4].copy_from_slice(&(-1_i32).to_ne_bytes());
        assert!(user_in(&answer).is_err());
    }
}
