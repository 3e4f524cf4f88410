//! The links of the command line.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::path::PathBuf;
use std::str::FromStr;

use fcc_mavlink::LinkOptions;

/// What a network carries for telemetry, bytes in a second, unless a link says otherwise.
const NETWORK_BYTES_PER_S: f64 = 200_000.0;
/// A byte on a serial line: 8 data bits, a start and a stop bit.
const LINE_BITS: f64 = 10.0;

/// Where a link leads to.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Way {
    /// To this address, and from it only.
    UdpTo(SocketAddr),
    /// From whoever is permitted.
    UdpIn(SocketAddr),
    /// Likewise.
    TcpIn(SocketAddr),
    /// A line, with its bits in a second.
    Serial(PathBuf, u32),
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UdpTo(to) => write!(f, "udp:{to}"),
            Self::UdpIn(at) => write!(f, "udpin:{at}"),
            Self::TcpIn(at) => write!(f, "tcpin:{at}"),
            Self::Serial(device, baud) => write!(f, "serial:{}:{baud}", device.display()),
        }
    }
}

/// A link: `udp:ADDRESS:PORT`, `udpin:…`, `tcpin:…` or `serial:DEVICE:BAUD`, with
/// `,rate=BYTES_PER_S` and `,high-latency` behind it.
#[derive(Clone, PartialEq, Debug)]
pub struct MavlinkLink {
    pub(crate) way: Way,
    pub(crate) options: LinkOptions,
}

/// Where stations and MAVSDK listen.
pub(crate) const USUAL: [u16; 2] = [14_550, 14_540];

impl MavlinkLink {
    pub(crate) fn usual() -> Vec<Self> {
        let to = |port| Self {
            way: Way::UdpTo((Ipv4Addr::LOCALHOST, port).into()),
            options: LinkOptions {
                bytes_per_s: NETWORK_BYTES_PER_S,
                is_datagram: true,
                is_high_latency: false,
            },
        };
        USUAL.map(to).into()
    }

    /// Whether other machines can reach it unasked.
    pub(crate) const fn is_open_to_others(&self) -> bool {
        match &self.way {
            Way::UdpIn(at) | Way::TcpIn(at) => !at.ip().is_loopback(),
            Way::UdpTo(_) | Way::Serial(..) => false,
        }
    }
}

impl FromStr for MavlinkLink {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.split(',');
        let first = parts.next().unwrap_or_default();
        let (kind, rest) = first.split_once(':').ok_or_else(usage)?;
        let address = || {
            let address = rest.parse::<SocketAddr>();
            let address = address
                .ok()
                .filter(|address: &SocketAddr| address.port() != 0);
            address.ok_or_else(|| format!("{rest}: give a numeric address and a port"))
        };
        let way = match kind {
            "udp" => Way::UdpTo(address()?),
            "udpin" => Way::UdpIn(address()?),
            "tcpin" => Way::TcpIn(address()?),
            "serial" => {
                let (device, baud) = rest.rsplit_once(':').ok_or_else(usage)?;
                let baud = baud.parse().ok().filter(|baud| *baud > 0);
                let baud = baud.ok_or_else(|| format!("{rest}: give a baud behind the device"))?;
                Way::Serial(device.into(), baud)
            }
            _ => return Err(usage()),
        };
        let mut options = LinkOptions {
            bytes_per_s: match way {
                Way::Serial(_, baud) => f64::from(baud) / LINE_BITS,
                _ => NETWORK_BYTES_PER_S,
            },
            is_datagram: matches!(way, Way::UdpTo(_) | Way::UdpIn(_)),
            is_high_latency: false,
        };
        for part in parts {
            match part.split_once('=') {
                None if part == "high-latency" => options.is_high_latency = true,
                Some(("rate", rate)) => {
                    let rate = rate.parse().ok().filter(|rate| (50.0..=1e8).contains(rate));
                    options.bytes_per_s =
                        rate.ok_or_else(|| format!("{part}: give 50 to 1e8 bytes in a second"))?;
                }
                _ => return Err(format!("{part}: give rate=BYTES_PER_S or high-latency")),
            }
        }
        Ok(Self { way, options })
    }
}

fn usage() -> String {
    "give udp:ADDRESS:PORT, udpin:ADDRESS:PORT, tcpin:ADDRESS:PORT or serial:DEVICE:BAUD".to_owned()
}

/// Any port of this machine from which an address can be reached.
pub(crate) const fn own(to: SocketAddr) -> SocketAddr {
    let ip = match to.ip() {
        IpAddr::V4(ip) if ip.is_loopback() => IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V4(_) => IpAddr::V4(Ipv4Addr::UNSPECIFIED),
        IpAddr::V6(ip) if ip.is_loopback() => IpAddr::V6(Ipv6Addr::LOCALHOST),
        IpAddr::V6(_) => IpAddr::V6(Ipv6Addr::UNSPECIFIED),
    };
    SocketAddr::new(ip, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_read_with_their_rates() {
        let link = |text: &str| text.parse::<MavlinkLink>();
        let udp = link("udp:127.0.0.1:14550").unwrap();
        assert_eq!(udp, MavlinkLink::usual()[0]);
        // 57,600 baud are 5,760 bytes.
        let serial = link("serial:/dev/ttyUSB0:57600").unwrap();
        assert_eq!(serial.options.bytes_per_s, 5_760.0);
        let slow = link("udp:10.0.0.2:14550,rate=300,high-latency").unwrap();
        assert_eq!(slow.options.bytes_per_s, 300.0);
        assert!(slow.options.is_high_latency && !slow.is_open_to_others());
        assert!(link("udpin:0.0.0.0:14550").unwrap().is_open_to_others());
        for wrong in [
            "",
            "udp",
            "udp:localhost:14550",
            "udp:127.0.0.1",
            "serial:/dev/ttyS0",
            "tcp:[::1]:1",
            "udp:127.0.0.1:1,rate=0",
            "udp:127.0.0.1:1,fast",
        ] {
            assert!(link(wrong).is_err(), "{wrong}");
        }
    }
}
