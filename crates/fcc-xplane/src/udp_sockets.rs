//! The UDP sockets of this machine, and whose they are, as the kernel shows them
//! in `/proc/net/udp` and `/proc/net/udp6` (proc(5)), read in the process's own
//! folder, which a service with `ProcSubset=pid` has, too.
//!
//! Any user may read these files. In a namespace of users that contains no
//! others, as in a service with `PrivateUsers=yes`, every other user has the
//! number of `nobody`.

use std::fs::File;
use std::io::{self, Read};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};

/// More than a machine with 10,000 sockets has.
const MOST_BYTES: u64 = 2_000_000;
/// The columns of a row: the local address, and the user's number.
const LOCAL_ADDRESS: usize = 1;
const USER: usize = 7;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Socket {
    port: u16,
    user: u32,
}

/// The sockets from which a datagram with one sender's address may come.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct UdpSockets(Vec<Socket>);

impl UdpSockets {
    /// Those that can send from this address. Reads two files, so not in a tick.
    ///
    /// # Errors
    /// When the kernel shows no sockets.
    pub(crate) fn sending_from(ip: IpAddr) -> io::Result<Self> {
        let read = |path: &str| {
            let mut text = String::new();
            File::open(path)?
                .take(MOST_BYTES)
                .read_to_string(&mut text)?;
            Ok::<_, io::Error>(text)
        };
        match ip {
            IpAddr::V4(_) => {
                let v4 = read("/proc/self/net/udp")?;
                // A kernel without IPv6 does not have it.
                let v6 = read("/proc/self/net/udp6").unwrap_or_default();
                Ok(Self::of(&[&v4, &v6], ip))
            }
            IpAddr::V6(_) => Ok(Self::of(&[&read("/proc/self/net/udp6")?], ip)),
        }
    }

    /// A port that is in an earlier table is not looked for in a later one: an
    /// IPv6 socket sends from an IPv4 address only where no IPv4 socket has its
    /// port.
    fn of(tables: &[&str], ip: IpAddr) -> Self {
        let mut found: Vec<Socket> = Vec::new();
        for table in tables {
            let earlier = found.len();
            for (address, socket) in table.lines().skip(1).filter_map(row) {
                let is_known = || {
                    let mut known = found.iter().take(earlier);
                    known.any(|other| other.port == socket.port)
                };
                if (address.is_unspecified() || address == ip) && !is_known() {
                    found.push(socket);
                }
            }
        }
        Self(found)
    }

    /// Whose socket this port is; none if no program has it.
    pub(crate) fn user_of(&self, port: u16) -> Option<u32> {
        let socket = self.0.iter().find(|socket| socket.port == port)?;
        Some(socket.user)
    }

    /// The ports of a user, each once.
    pub(crate) fn ports_of(&self, user: u32) -> Vec<u16> {
        let own = self.0.iter().filter(|socket| socket.user == user);
        let mut ports: Vec<u16> = own.map(|socket| socket.port).collect();
        ports.sort_unstable();
        ports.dedup();
        ports
    }
}

fn row(line: &str) -> Option<(IpAddr, Socket)> {
    let mut columns = line.split_ascii_whitespace();
    let (address, port) = columns.nth(LOCAL_ADDRESS)?.split_once(':')?;
    let user = columns.nth(USER - LOCAL_ADDRESS - 1)?.parse().ok()?;
    let port = u16::from_str_radix(port, 16).ok()?;
    Some((hexadecimal(address)?, Socket { port, user }))
}

/// An address as the kernel prints it: words of 32 bits, each in the machine's
/// order of bytes.
fn hexadecimal(text: &str) -> Option<IpAddr> {
    let word = |at: usize| {
        let digits = text.get(at * 8..at * 8 + 8)?;
        Some(u32::from_str_radix(digits, 16).ok()?.to_ne_bytes())
    };
    if text.len() == 8 {
        return Some(Ipv4Addr::from(word(0)?).into());
    }
    let mut bytes = [0; 16];
    for (at, chunk) in bytes.chunks_exact_mut(4).enumerate() {
        chunk.copy_from_slice(&word(at)?);
    }
    Some(Ipv6Addr::from(bytes).to_canonical())
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;
    use std::os::unix::fs::MetadataExt;

    use super::*;

    const HEAD: &str = "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when \
                        retrnsmt   uid  timeout inode ref pointer drops\n";

    /// Rows as proc(5) describes them, of a machine with the least significant
    /// byte first.
    #[cfg(target_endian = "little")]
    #[test]
    fn a_port_belongs_to_the_user_of_the_socket_that_sends_from_the_address() {
        let rest = "00000000:0000 07 00000000:00000000 00:00000000 00000000";
        let v4 = format!(
            "{HEAD} 1: 00000000:BF69 {rest}  1000 0 1 2 0 0\n 2: 0200007F:BF6A {rest}  1001 0 1 2 0 0\n \
             3: 0100007F:BF6B {rest}  1002 0 1 2 0 0\nnonsense\n"
        );
        let v6 = format!(
            "{HEAD} 1: 00000000000000000000000000000000:BF69 {rest}  1003 0 1 2 0 0\n \
             2: 0000000000000000FFFF00000100007F:BF6C {rest}  1000 0 1 2 0 0\n \
             3: 00000000000000000000000001000000:BF6D {rest}  1003 0 1 2 0 0\n"
        );
        let found = UdpSockets::of(&[&v4, &v6], "127.0.0.1".parse().unwrap());
        let users = [0xBF69, 0xBF6A, 0xBF6B, 0xBF6C, 0xBF6D].map(|port| found.user_of(port));
        assert_eq!(users, [Some(1000), None, Some(1002), Some(1000), None]);
        assert_eq!(found.ports_of(1000), [0xBF69, 0xBF6C]);
        let found = UdpSockets::of(&[&v6], "::1".parse().unwrap());
        assert_eq!(found.user_of(0xBF6D), Some(1003));
        assert_eq!(found.user_of(0xBF6C), None);
    }

    #[test]
    fn the_kernel_shows_a_socket_of_this_user_until_it_is_closed() {
        for host in ["127.0.0.1", "[::1]"] {
            let socket = UdpSocket::bind(format!("{host}:0")).unwrap();
            let at = socket.local_addr().unwrap();
            let user = || {
                UdpSockets::sending_from(at.ip())
                    .unwrap()
                    .user_of(at.port())
            };
            let own = std::fs::metadata("/proc/self").unwrap().uid();
            assert_eq!(user(), Some(own), "{host}");
            drop(socket);
            assert_eq!(user(), None, "{host}");
        }
    }
}
