//! Where X-Plane is: at an address, at a named host, or wherever its beacon
//! comes from.

use core::fmt;
use core::str::FromStr;
use std::io;
use std::net::{IpAddr, SocketAddr, ToSocketAddrs};

/// The port on which X-Plane listens.
pub const XPLANE_PORT: u16 = 49_000;

/// The port from which X-Plane sends, unless it was changed there.
pub(crate) const XPLANE_REPLY_PORT: u16 = 49_001;

/// The port that is received on here unless another is configured, for a rule
/// of a firewall. Not one of those known to be used by X-Plane or by programs
/// for it: 49000 to 49010 and 49707.
pub const USUAL_LOCAL_PORT: u16 = 49_071;

/// Where X-Plane is. As text: `beacon`, an IP address or a host name, the last
/// two with a port if it is not 49000.
///
/// ```
/// use fcc_xplane::Simulator;
///
/// let simulator: Simulator = "192.168.1.20".parse()?;
/// assert_eq!(simulator.to_string(), "192.168.1.20:49000");
/// assert!(matches!("sim.lan".parse()?, Simulator::Named(_)));
/// assert!("192.168.1.300".parse::<Simulator>().is_err());
/// # Ok::<(), fcc_xplane::AddressError>(())
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Simulator {
    /// At this address. For X-Plane on this machine use 127.0.0.1: only
    /// datagrams from exactly this IP address are accepted.
    At(SocketAddr),
    /// At the host with this name, which is looked up once when the connection
    /// is opened: its first IPv4 address, otherwise its first IPv6 address.
    Named(HostName),
    /// At the sender of the first beacon of an X-Plane that computes a flight.
    /// While it sends, other beacons are ignored.
    Beacon,
}

/// A host name and a port.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct HostName {
    name: String,
    port: u16,
}

/// A text that is no address of an X-Plane.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[error(
    "\"{0}\" is neither \"beacon\" nor an address: give an IP address or a host name, with the \
     port if it is not {XPLANE_PORT}, such as \"127.0.0.1:49000\", \"[::1]:49000\" or \"sim.lan\""
)]
pub struct AddressError(String);

const BEACON: &str = "beacon";
/// Longest host name and longest part of one, bytes (RFC 1035, 2.3.4).
const LONGEST_NAME: usize = 253;
const LONGEST_PART: usize = 63;

impl fmt::Display for Simulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::At(address) => address.fmt(f),
            Self::Named(host) => host.fmt(f),
            Self::Beacon => f.write_str(BEACON),
        }
    }
}

impl fmt::Display for HostName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.name, self.port)
    }
}

impl FromStr for Simulator {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let error = || AddressError(text.to_owned());
        if text == BEACON {
            return Ok(Self::Beacon);
        }
        if let Ok(address) = text.parse() {
            return Ok(Self::At(canonical(address)));
        }
        let bare = text.strip_prefix('[').and_then(|ip| ip.strip_suffix(']'));
        if let Ok(ip) = bare.unwrap_or(text).parse::<IpAddr>() {
            return Ok(Self::At(canonical((ip, XPLANE_PORT).into())));
        }
        let (name, port) = match text.rsplit_once(':') {
            Some((name, port)) => (name, port.parse().map_err(|_| error())?),
            None => (text, XPLANE_PORT),
        };
        if port == 0 || !is_host_name(name) {
            return Err(error());
        }
        Ok(Self::Named(HostName {
            name: name.to_owned(),
            port,
        }))
    }
}

/// Converts an IPv4-mapped IPv6 address (`::ffff:127.0.0.1`) to IPv4.
fn canonical(address: SocketAddr) -> SocketAddr {
    match address.ip().to_canonical() {
        ip @ IpAddr::V4(_) => (ip, address.port()).into(),
        IpAddr::V6(_) => address,
    }
}

/// Letters, digits and hyphens between dots (RFC 1123, 2.1), and underscores,
/// which some networks use. The last part must not be a number: that would be a
/// mistyped address.
fn is_host_name(name: &str) -> bool {
    let name = name.strip_suffix('.').unwrap_or(name);
    let is_part = |part: &str| {
        (1..=LONGEST_PART).contains(&part.len())
            && !part.starts_with('-')
            && !part.ends_with('-')
            && part
                .bytes()
                .all(|byte| byte.is_ascii_alphanumeric() || b"-_".contains(&byte))
    };
    let last = name.rsplit('.').next().unwrap_or_default();
    name.len() <= LONGEST_NAME
        && name.split('.').all(is_part)
        && !last.bytes().all(|byte| byte.is_ascii_digit())
}

impl HostName {
    /// Asks the network, and may wait for it.
    pub(crate) fn look_up(&self) -> io::Result<SocketAddr> {
        let found: Vec<SocketAddr> = (self.name.as_str(), self.port).to_socket_addrs()?.collect();
        let first = found.iter().find(|address| address.is_ipv4());
        let first = first.or(found.first()).copied();
        first.ok_or_else(|| io::Error::other("it has no address"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> String {
        let simulator: Simulator = text.parse().unwrap();
        let again: Simulator = simulator.to_string().parse().unwrap();
        assert_eq!(simulator, again);
        simulator.to_string()
    }

    #[test]
    fn addresses_and_names_are_read_with_and_without_a_port() {
        for (text, expected) in [
            ("beacon", "beacon"),
            ("127.0.0.1:49000", "127.0.0.1:49000"),
            ("192.168.1.20", "192.168.1.20:49000"),
            ("[::1]:49010", "[::1]:49010"),
            ("[::1]", "[::1]:49000"),
            ("::1", "[::1]:49000"),
            ("[fe80::1%2]:49000", "[fe80::1%2]:49000"),
            ("::ffff:10.0.0.1", "10.0.0.1:49000"),
            ("pi.local:49000", "pi.local:49000"),
            ("sim.lan", "sim.lan:49000"),
            ("SIM-2_b", "SIM-2_b:49000"),
        ] {
            assert_eq!(read(text), expected);
        }
    }

    #[test]
    fn text_that_is_no_address_is_refused_with_an_example() {
        let long = format!("{}.lan", "a".repeat(64));
        for text in [
            "",
            " ",
            "127.0.0.1:",
            "127.0.0.1:65536",
            "192.168.1.300",
            "192.168.1.3.4",
            "49000",
            "sim.lan:0",
            "sim.lan:port",
            "sim lan",
            "-sim.lan",
            "sim..lan",
            "[::1",
            "::1]:49000",
            "http://sim.lan",
            "größe.lan",
            &long,
        ] {
            let error = text.parse::<Simulator>().unwrap_err().to_string();
            assert!(error.contains(&format!("\"{text}\"")), "{error}");
            assert!(error.contains("[::1]:49000"), "{error}");
        }
    }
}
