//! `BECN`: the multicast beacon by which X-Plane announces its address.
//!
//! After the header: u8 major, u8 minor, i32 host, i32 version, u32 role, u16
//! port, then the computer's name up to a NUL.
//!
//! Sources conflict on whether the name has a fixed length, so it is read up to
//! the NUL or the end, whichever comes first. Another plugin sends a different
//! beacon under the same four letters (on port 49710), so every field is
//! checked before any is used.

use core::net::{Ipv4Addr, SocketAddrV4};

use super::{Kind, Malformed, body, fields};

/// Where X-Plane sends its beacon.
pub const GROUP: SocketAddrV4 = SocketAddrV4::new(Ipv4Addr::new(239, 255, 1, 1), 49_707);

/// The supported major version of the beacon; increments of the minor version
/// (1 in X-Plane 10.40, 2 in 11.50) have only appended fields.
const MAJOR: u8 = 1;
/// Versions from X-Plane 9 to 99: a beacon outside this range is not X-Plane's.
const VERSIONS: core::ops::RangeInclusive<i32> = 90_000..=999_999;
/// An upper bound for the length of a computer's name.
const LONGEST_NAME: usize = 500;

/// What sends the beacon.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Host {
    /// X-Plane itself.
    XPlane,
    /// Plane Maker, which computes no flight.
    PlaneMaker,
}

/// The role of an X-Plane in a network of several.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// Computes the flight: the one to connect to.
    Master,
    /// Displays what a master computes.
    ExternalVisual,
    /// An instructor's station.
    Instructor,
}

/// A beacon.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Beacon<'a> {
    /// The beacon's minor version.
    pub minor: u8,
    /// What sends it.
    pub host: Host,
    /// X-Plane's version: 115501 is 11.55r01.
    pub version: u32,
    /// The sender's role in its network.
    pub role: Role,
    /// The UDP port it listens on.
    pub port: u16,
    /// The computer's name, in whatever encoding it uses.
    pub name: &'a [u8],
}

impl Beacon<'_> {
    /// Whether this sender computes a flight that can be controlled from here.
    pub const fn is_flyable(&self) -> bool {
        matches!(self.host, Host::XPlane) && matches!(self.role, Role::Master)
    }
}

/// Reads a beacon.
///
/// # Errors
/// When it is another message, too short, or has a field that X-Plane's own
/// beacon never has.
pub fn parse(datagram: &[u8]) -> Result<Beacon<'_>, Malformed> {
    let mut fields = fields::Fields::of(body(datagram, Kind::Beacon)?);
    let major = fields.u8().ok_or(Malformed::Length)?;
    let minor = fields.u8().ok_or(Malformed::Length)?;
    let host = fields.i32().ok_or(Malformed::Length)?;
    let version = fields.i32().ok_or(Malformed::Length)?;
    let role = fields.u32().ok_or(Malformed::Length)?;
    let port = fields.u16().ok_or(Malformed::Length)?;
    let name = fields
        .rest()
        .split(|byte| *byte == 0)
        .next()
        .unwrap_or_default();

    let host = match host {
        1 => Host::XPlane,
        2 => Host::PlaneMaker,
        _ => return Err(Malformed::Field),
    };
    let role = match role {
        1 => Role::Master,
        2 => Role::ExternalVisual,
        3 => Role::Instructor,
        _ => return Err(Malformed::Field),
    };
    let plausible = major == MAJOR
        && minor > 0
        && VERSIONS.contains(&version)
        && port != 0
        && name.len() <= LONGEST_NAME;
    if !plausible {
        return Err(Malformed::Field);
    }
    Ok(Beacon {
        minor,
        host,
        version: version.unsigned_abs(),
        role,
        port,
        name,
    })
}
