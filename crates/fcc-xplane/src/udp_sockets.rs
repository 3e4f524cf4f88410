//! The UDP sockets of this machine, and whose they are.
//!
//! A single socket is asked for by its address ([`SocketDiagnosis`]). Which
//! ports a user has is read in `/proc/net/udp` and `/proc/net/udp6` (proc(5)), in
//! the process's own folder, which a service with `ProcSubset=pid` has, too. That
//! list may lack sockets: any user may open more than are read, and the kernel
//! leaves some out while others are closed. So it only says which ports to ask
//! for. Where the kernel answers no questions, what is in the list is true, and
//! what is missing in a list that was read to its end is closed.
//!
//! Any user may ask and read. In a namespace of users that contains no others,
//! as in a service with `PrivateUsers=yes`, every other user has the number of
//! `nobody`.

use std::fs::File;
use std::io::{self, Read};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use crate::program::Program;
use crate::socket_diagnosis::SocketDiagnosis;

/// More than a machine with 10,000 sockets has.
const MOST_BYTES: usize = 2_000_000;
/// The columns of a row: the local address, the user's number, and that of the socket.
const LOCAL_ADDRESS: usize = 1;
const USER: usize = 7;
const INODE: usize = 9;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Socket {
    port: u16,
    user: u32,
    inode: u64,
}

/// The sockets from which a datagram with one sender's address may come.
#[derive(Debug)]
pub(crate) struct UdpSockets {
    ip: IpAddr,
    kernel: Option<SocketDiagnosis>,
    /// None before something in it is asked for: reading it can take a second, with
    /// thousands of sockets.
    listed: Option<Listed>,
}

impl UdpSockets {
    /// Those that can send from this address. Not in a tick, as everything here.
    pub(crate) fn sending_from(ip: IpAddr) -> Self {
        Self {
            ip,
            kernel: SocketDiagnosis::open().ok(),
            listed: None,
        }
    }

    /// Makes what is asked next be looked for anew.
    pub(crate) fn look(&mut self) {
        self.listed = None;
    }

    /// Without a list a single one can still be asked for.
    fn listed(&mut self) -> &Listed {
        self.listed
            .get_or_insert_with(|| Listed::read(self.ip, MOST_BYTES).unwrap_or_default())
    }

    /// Whose socket this port is; none if no program has it.
    ///
    /// # Errors
    /// When that is not known.
    pub(crate) fn user_of(&mut self, port: u16) -> io::Result<Option<u32>> {
        let asked = match &mut self.kernel {
            Some(kernel) => kernel.user_of(SocketAddr::new(self.ip, port)),
            None => Err(io::ErrorKind::Unsupported.into()),
        };
        if let Ok(Some(user)) = asked {
            return Ok(Some(user));
        }
        // One that is connected to another address is only listed.
        let listed = self.listed();
        match (asked, listed.user_of(port)) {
            (_, Some(user)) => Ok(Some(user)),
            (Err(error), None) if !listed.is_whole => Err(error),
            (_, None) => Ok(None),
        }
    }

    /// The program that has this port, by the list; none if it cannot be found out.
    pub(crate) fn program_at(&mut self, port: u16) -> Option<Program> {
        let mut listed = self.listed().sockets.iter();
        Program::with_socket(listed.find(|socket| socket.port == port)?.inode)
    }

    /// The ports of a user, those that are `likely` first, each once; at most so
    /// many.
    pub(crate) fn ports_of(&mut self, user: u32, likely: &[u16], most: usize) -> Vec<u16> {
        let mut ports: Vec<u16> = likely.to_vec();
        ports.extend(self.listed().ports_of(user));
        let mut found = Vec::new();
        for port in ports {
            let is_new = port != 0 && found.len() < most && !found.contains(&port);
            if is_new && self.user_of(port).ok().flatten() == Some(user) {
                found.push(port);
            }
        }
        found
    }
}

/// The sockets in the kernel's lists.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
struct Listed {
    sockets: Vec<Socket>,
    /// Whether the lists were read to their ends.
    is_whole: bool,
}

impl Listed {
    fn read(ip: IpAddr, most_bytes: usize) -> io::Result<Self> {
        let mut is_whole = true;
        let mut read = |path: &str| {
            let mut text = String::new();
            let limit = most_bytes as u64;
            is_whole &= File::open(path)?.take(limit).read_to_string(&mut text)? < most_bytes;
            Ok::<_, io::Error>(text)
        };
        let sockets = match ip {
            IpAddr::V4(_) => {
                let v4 = read("/proc/self/net/udp")?;
                // A kernel without IPv6 does not have it.
                let v6 = read("/proc/self/net/udp6").unwrap_or_default();
                Self::of(&[&v4, &v6], ip)
            }
            IpAddr::V6(_) => Self::of(&[&read("/proc/self/net/udp6")?], ip),
        };
        Ok(Self { sockets, is_whole })
    }

    /// A port that is in an earlier table is not looked for in a later one: an
    /// IPv6 socket sends from an IPv4 address only where no IPv4 socket has its
    /// port.
    fn of(tables: &[&str], ip: IpAddr) -> Vec<Socket> {
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
        found
    }

    fn user_of(&self, port: u16) -> Option<u32> {
        let socket = self.sockets.iter().find(|socket| socket.port == port)?;
        Some(socket.user)
    }

    fn ports_of(&self, user: u32) -> impl Iterator<Item = u16> {
        let own = self
            .sockets
            .iter()
            .filter(move |socket| socket.user == user);
        own.map(|socket| socket.port)
    }
}

fn row(line: &str) -> Option<(IpAddr, Socket)> {
    let mut columns = line.split_ascii_whitespace();
    let (address, port) = columns.nth(LOCAL_ADDRESS)?.split_once(':')?;
    let user = columns.nth(USER - LOCAL_ADDRESS - 1)?.parse().ok()?;
    let inode = columns.nth(INODE - USER - 1)?.parse().ok()?;
    let port = u16::from_str_radix(port, 16).ok()?;
    Some((hexadecimal(address)?, Socket { port, user, inode }))
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
        let listed = |tables: &[&str], ip: &str| Listed {
            sockets: Listed::of(tables, ip.parse().unwrap()),
            is_whole: true,
        };
        let found = listed(&[&v4, &v6], "127.0.0.1");
        let users = [0xBF69, 0xBF6A, 0xBF6B, 0xBF6C, 0xBF6D].map(|port| found.user_of(port));
        assert_eq!(users, [Some(1000), None, Some(1002), Some(1000), None]);
        assert_eq!(found.ports_of(1000).collect::<Vec<_>>(), [0xBF69, 0xBF6C]);
        let found = listed(&[&v6], "::1");
        assert_eq!(found.user_of(0xBF6D), Some(1003));
        assert_eq!(found.user_of(0xBF6C), None);
    }

    fn own_user() -> u32 {
        std::fs::metadata("/proc/self").unwrap().uid()
    }

    #[test]
    fn the_kernel_shows_a_socket_of_this_user_until_it_is_closed() {
        for host in ["127.0.0.1", "[::1]"] {
            let socket = UdpSocket::bind(format!("{host}:0")).unwrap();
            let at = socket.local_addr().unwrap();
            let mut sockets = UdpSockets::sending_from(at.ip());
            let mut user = || {
                sockets.look();
                sockets.user_of(at.port()).unwrap()
            };
            assert_eq!(user(), Some(own_user()), "{host}");
            drop(socket);
            assert_eq!(user(), None, "{host}");
        }
    }

    /// Others may open more sockets than are listed.
    #[test]
    fn a_socket_that_is_not_listed_is_found() {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let port = socket.local_addr().unwrap().port();
        let ip = [127, 0, 0, 1].into();
        let mut sockets = UdpSockets::sending_from(ip);
        assert_eq!(sockets.user_of(port).unwrap(), Some(own_user()));
        assert_eq!(sockets.listed, None);
        let begun = Listed::read(ip, HEAD.len()).unwrap();
        assert_eq!(begun.sockets, []);
        sockets.listed = Some(begun);
        assert_eq!(sockets.user_of(port).unwrap(), Some(own_user()));
        assert_eq!(sockets.ports_of(own_user(), &[port], 1), [port]);
        assert_eq!(sockets.ports_of(own_user() + 1, &[port], 1), []);
        // Where the kernel answers no questions, it may be open.
        sockets.kernel = None;
        assert!(sockets.user_of(port).is_err());
        sockets.look();
        assert_eq!(sockets.user_of(port).unwrap(), Some(own_user()));
        drop(socket);
        sockets.look();
        assert_eq!(sockets.user_of(port).unwrap(), None);
    }
}
