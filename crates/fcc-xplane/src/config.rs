//! What a user may choose, and what is refused.

use core::time::Duration;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4};

use crate::address::{self, Simulator};
use crate::protocol::{PathError, beacon, check_path, rref};

/// The port on which X-Plane listens.
pub const XPLANE_PORT: u16 = 49_000;

/// How X-Plane is reached and what is read and written.
///
/// ```
/// use fcc_xplane::{Simulator, XPlaneConfig};
///
/// let config = XPlaneConfig {
///     simulator: Simulator::At("192.168.1.20:49000".parse().unwrap()),
///     engines: 2,
///     ..XPlaneConfig::default()
/// };
/// assert!(config.validate().is_ok());
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct XPlaneConfig {
    /// Where X-Plane is. Default: 127.0.0.1:49000.
    pub simulator: Simulator,
    /// The UDP port to receive on, 0 for any that is free. Default: 0, since
    /// RREF answers to whatever port asked; rows of Data Output go where the
    /// user sent them, so [`Input::Data`] needs one.
    pub local_port: u16,
    /// How measurements come. Default: [`Input::Rref`].
    pub input: Input,
    /// How surfaces go. Default: [`Output::Dref`].
    pub output: Output,
    /// How often X-Plane is asked to send each dataref, Hz, 1..=1000; it sends
    /// at most once a frame. Default: 100, so that a value is no older than
    /// its frame.
    pub rate_hz: u16,
    /// How many engines take the throttle, 1..=8. Default: 1.
    pub engines: u8,
    /// The dataref that engages: on from 0.5 up. Default:
    /// `sim/cockpit2/switches/generic_lights_switch[0]`, which nothing else in
    /// X-Plane reads.
    pub engage_switch: String,
    /// After so long without a dataref's value it is asked for again, 100 ms
    /// to 1 h. Default: 5 s.
    pub resubscribe: Duration,
    /// After so long without a datagram the simulator counts as silent, 50 ms
    /// to 1 min. Default: 500 ms.
    pub silent_after: Duration,
    /// The most datagrams read in one tick, 1..=1000. Default: 64, over ten
    /// times what comes; a flood delays nothing.
    pub datagrams_per_tick: u16,
    /// After so long without a reading, that of another sensor is preferred
    /// where a loop has several. Default: 100 ms, two frames at the lowest rate
    /// that is not slow.
    pub fallback_after: Duration,
    /// Where beacons are sent. Default: 239.255.1.1:49707.
    pub beacon: SocketAddrV4,
}

impl Default for XPlaneConfig {
    fn default() -> Self {
        Self {
            simulator: Simulator::At((Ipv4Addr::LOCALHOST, XPLANE_PORT).into()),
            local_port: 0,
            input: Input::Rref,
            output: Output::Dref,
            rate_hz: 100,
            engines: 1,
            engage_switch: "sim/cockpit2/switches/generic_lights_switch[0]".to_owned(),
            resubscribe: Duration::from_secs(5),
            silent_after: Duration::from_millis(500),
            datagrams_per_tick: 64,
            fallback_after: fcc_core::framework::FALLBACK_AFTER,
            beacon: beacon::GROUP,
        }
    }
}

/// How measurements come.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// By subscribed datarefs: no set-up in X-Plane's menus, and no doubt
    /// about units and columns.
    Rref,
    /// By rows 1, 3, 4, 16, 17, 18, 20 and 21 of Data Output (in X-Plane 9: 17,
    /// 18, 19 for 16, 17, 18), which the user has switched on and directed to
    /// [`XPlaneConfig::local_port`]. The switch, the pause and the read-back of
    /// the overrides have no row and are still subscribed.
    Data(DataRows),
}

/// Which columns the rows have: versions of X-Plane differ.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DataRows {
    /// The version that sends them.
    pub version: RowsVersion,
    /// The column of magnetic heading in the attitude row, 2..=7: 3 by most
    /// sources, 4 in one capture of X-Plane 12. Look at Data Output on the
    /// screen.
    pub magnetic_heading_column: u8,
}

impl DataRows {
    /// What most sources say of a version.
    pub const fn of(version: RowsVersion) -> Self {
        Self {
            version,
            magnetic_heading_column: 3,
        }
    }
}

/// A version of X-Plane, as far as rows differ.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RowsVersion {
    /// X-Plane 9: rates (Q, P, R in rad/s) in row 17, attitude in 18, air
    /// angles in 19.
    XPlane9,
    /// X-Plane 10 and 11: rates (Q, P, R in rad/s) in row 16, attitude in 17,
    /// air angles in 18.
    XPlane10,
    /// X-Plane 12: as 10, but rates are P, Q, R in deg/s.
    XPlane12,
}

/// How surfaces go. The overrides are set by DREF either way.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Output {
    /// By datarefs.
    Dref,
    /// By rows 8 (joystick) and 25 (throttles), two rows in one datagram.
    Data,
}

/// What is wrong with a configuration.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum XPlaneConfigError {
    /// A number is out of its range.
    #[error("{key} is {value}: choose {range}")]
    Range {
        /// The field.
        key: &'static str,
        /// What it holds.
        value: String,
        /// What it may hold.
        range: &'static str,
    },
    /// The engage switch is no dataref path.
    #[error("engage_switch \"{path}\": {source}")]
    EngageSwitch {
        /// What it holds.
        path: String,
        /// What is wrong with it.
        source: PathError,
    },
    /// An address to which nothing can be sent.
    #[error("simulator {0}: give the IP address and port of one machine, such as 127.0.0.1:49000")]
    Simulator(SocketAddr),
    /// An address that every network of this machine may have.
    #[error(
        "simulator {0} is an address within one network: give the network's interface too, such \
         as [fe80::1%2]:49000, where 2 is its number in `ip link`"
    )]
    NoInterface(SocketAddr),
    /// Rows are the input, but there is no port to receive them on.
    #[error(
        "input by Data Output needs local_port: the one that is set as the target port in X-Plane"
    )]
    LocalPort,
}

impl XPlaneConfig {
    /// Whether everything is in its range.
    ///
    /// # Errors
    /// The first field that is not, with what would be right.
    pub fn validate(&self) -> Result<(), XPlaneConfigError> {
        range("rate_hz", self.rate_hz, 1, 1_000, "1 to 1000")?;
        range("engines", self.engines, 1, 8, "1 to 8")?;
        let most = self.datagrams_per_tick;
        range("datagrams_per_tick", most, 1, 1_000, "1 to 1000")?;
        let (least, most) = (Duration::from_millis(100), Duration::from_secs(3_600));
        let again = Span(self.resubscribe);
        range(
            "resubscribe",
            again,
            Span(least),
            Span(most),
            "100 ms to 1 h",
        )?;
        let (least, most) = (Duration::from_millis(50), Duration::from_secs(60));
        let silent = Span(self.silent_after);
        range(
            "silent_after",
            silent,
            Span(least),
            Span(most),
            "50 ms to 1 min",
        )?;
        if self.beacon.port() == 0 {
            range("beacon port", 0, 1, u16::MAX, "1 to 65535")?;
        }
        check_path(&self.engage_switch, rref::PATH_BYTES).map_err(|source| {
            XPlaneConfigError::EngageSwitch {
                path: self.engage_switch.clone(),
                source,
            }
        })?;
        if let Simulator::At(at) = self.simulator {
            address::check(at)?;
        }
        if let Input::Data(rows) = self.input {
            let column = rows.magnetic_heading_column;
            range("magnetic_heading_column", column, 2, 7, "2 to 7")?;
            if self.local_port == 0 {
                return Err(XPlaneConfigError::LocalPort);
            }
        }
        Ok(())
    }
}

/// A duration that prints as one.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Span(Duration);

impl core::fmt::Display for Span {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:?}", self.0)
    }
}

fn range<T: Copy + PartialOrd + core::fmt::Display>(
    key: &'static str,
    value: T,
    least: T,
    most: T,
    range: &'static str,
) -> Result<(), XPlaneConfigError> {
    if value < least || value > most {
        let value = value.to_string();
        return Err(XPlaneConfigError::Range { key, value, range });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complaint(change: impl FnOnce(&mut XPlaneConfig)) -> String {
        let mut config = XPlaneConfig::default();
        change(&mut config);
        config.validate().unwrap_err().to_string()
    }

    #[test]
    fn the_defaults_are_valid() {
        XPlaneConfig::default().validate().unwrap();
    }

    #[test]
    fn what_is_wrong_is_said_with_what_would_be_right() {
        assert_eq!(complaint(|c| c.engines = 9), "engines is 9: choose 1 to 8");
        assert_eq!(complaint(|c| c.engines = 0), "engines is 0: choose 1 to 8");
        assert_eq!(
            complaint(|c| c.resubscribe = Duration::from_millis(20)),
            "resubscribe is 20ms: choose 100 ms to 1 h"
        );
        assert_eq!(
            complaint(|c| c.engage_switch = "a".repeat(400)),
            format!(
                "engage_switch \"{}\": the dataref path is 400 bytes long: at most 399 fit",
                "a".repeat(400)
            )
        );
        assert!(complaint(|c| c.engage_switch.clear()).contains("is empty"));
        assert!(complaint(|c| c.engage_switch = "sim/größe".into()).contains("no dataref has"));
        assert!(complaint(|c| c.engage_switch = "sim/a\0b".into()).contains("no dataref has"));
        let nowhere = (Ipv4Addr::UNSPECIFIED, 49_000).into();
        assert!(complaint(|c| c.simulator = Simulator::At(nowhere)).contains("127.0.0.1:49000"));
        let rows = Input::Data(DataRows::of(RowsVersion::XPlane12));
        assert!(complaint(|c| c.input = rows).contains("local_port"));
    }

    #[test]
    fn a_path_of_399_bytes_is_the_longest() {
        let config = XPlaneConfig {
            engage_switch: "a".repeat(399),
            ..XPlaneConfig::default()
        };
        config.validate().unwrap();
    }
}
