//! The connection's configuration and its validation.

use core::time::Duration;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4};

use crate::address::{Simulator, XPLANE_PORT, XPLANE_REPLY_PORT};
use crate::engage_switch;
use crate::protocol::{PathError, beacon, check_path, rref};

/// How X-Plane is reached, and what is read and written.
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
    /// What is there. Default: a simulator.
    pub plant: PlantKind,
    /// The UDP port to receive on. Default: 0 for
    /// [`USUAL_LOCAL_PORT`](crate::USUAL_LOCAL_PORT), or
    /// another that is free if a program has it, or if X-Plane is on this
    /// machine, where no firewall needs a rule. RREF replies go to the port that
    /// sent the request. Rows of Data Output go to the port that is set in
    /// X-Plane, so [`Input::Data`] needs one.
    pub local_port: u16,
    /// The port from which X-Plane is expected to answer, 0 if that is not
    /// known: while nothing is held, it is preferred to one that was learned.
    /// While it is silent, a datagram without effect is sent there each second,
    /// so that a firewall on this side lets the replies in; afterwards to the
    /// port that answers, every 20 s. Default: 49001, X-Plane's own.
    pub reply_port: u16,
    /// How measurements are received. Default: [`Input::Rref`].
    pub input: Input,
    /// How control surfaces are written. Default: [`Output::Dref`].
    pub output: Output,
    /// The rate at which X-Plane is asked to send each dataref, Hz, 1..=1000;
    /// it sends at most once per frame. Above this number of frames a second,
    /// values of one frame are missing in others. Default: 250, more than most
    /// computers draw.
    pub rate_hz: u16,
    /// The number of engines whose throttle is written, 1..=8. Default: 1.
    pub engines: u8,
    /// The dataref of the engage switch: on from 0.75 upwards, off below 0.25,
    /// unchanged in between. Default:
    /// `sim/cockpit2/switches/generic_lights_switch[56]`, which no aircraft is
    /// known to use, and which the command `sim/lights/generic_57_light_tog`
    /// switches.
    pub engage_switch: String,
    /// Whether the axes of the pilot's own stick and pedals are read, which
    /// X-Plane has since 11.5. Default: no.
    pub pilot_controls: bool,
    /// A dataref without a value for this long is requested again, 100 ms to 1
    /// h. Default: 5 s.
    pub resubscribe: Duration,
    /// The simulator counts as silent after this long without a datagram, 50 ms
    /// to 1 min. Default: 500 ms.
    pub silent_after: Duration,
    /// The most datagrams read in one tick, 1..=1000; the rest are discarded,
    /// so that no reading is older than a period. Default: 128, over ten times
    /// the usual number, so that a flood of datagrams cannot delay a tick.
    pub datagrams_per_tick: u16,
    /// Where a loop has several sources of a quantity, another source is
    /// preferred after this long without a reading. Default: 100 ms, two frames
    /// at the lowest rate that is not slow.
    pub fallback_after: Duration,
    /// The multicast group of the beacons. Default: 239.255.1.1:49707.
    pub beacon: SocketAddrV4,
}

impl Default for XPlaneConfig {
    fn default() -> Self {
        Self {
            simulator: Simulator::At((Ipv4Addr::LOCALHOST, XPLANE_PORT).into()),
            plant: PlantKind::Simulator,
            local_port: 0,
            reply_port: XPLANE_REPLY_PORT,
            input: Input::Rref,
            output: Output::Dref,
            rate_hz: 250,
            engines: 1,
            engage_switch: engage_switch::DEFAULT.to_owned(),
            pilot_controls: false,
            resubscribe: Duration::from_secs(5),
            silent_after: Duration::from_millis(500),
            datagrams_per_tick: 128,
            fallback_after: fcc_core::framework::FALLBACK_AFTER,
            beacon: beacon::GROUP,
        }
    }
}

/// What is at the other end, and so which values it is asked for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PlantKind {
    /// X-Plane, or another simulator: all that it has.
    Simulator,
    /// A servo board that speaks X-Plane's messages: airspeed or differential
    /// pressure, the engage switch, and where the servos are. What it does not
    /// send is not missing, except who has control.
    ServoBoard,
}

impl PlantKind {
    /// After this long without a message, everything is requested again: it may
    /// have been started again. A simulator may stand still for some frames; a
    /// board sends 50 times a second, and holds the only switch.
    pub(crate) const fn lost_after(self) -> Duration {
        match self {
            Self::Simulator => Duration::from_secs(1),
            Self::ServoBoard => Duration::from_millis(250),
        }
    }

    /// While control is held, the overrides are set again at this interval, in case
    /// a datagram was lost or the other end was started again.
    pub(crate) const fn assert_every(self) -> Duration {
        match self {
            Self::Simulator => Duration::from_secs(1),
            Self::ServoBoard => Duration::from_millis(250),
        }
    }
}

/// How measurements are received.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// As subscribed datarefs: no set-up in X-Plane's menus, and unambiguous
    /// units and columns.
    Rref,
    /// As rows 1, 3, 4, 16, 17, 18, 20 and 21 of Data Output (in X-Plane 9: 17,
    /// 18, 19 for 16, 17, 18), which the user has enabled and sent to
    /// [`XPlaneConfig::local_port`]. The engage switch, the pause and the
    /// readback of the overrides have no row and are still subscribed.
    Data(DataRows),
}

/// The layout of the rows, which differs between versions of X-Plane.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DataRows {
    /// The version of X-Plane that sends them.
    pub version: RowsVersion,
    /// The column of magnetic heading in the attitude row, 2..=7: 3 by most
    /// sources, 4 in one capture of X-Plane 12. Compare with Data Output on
    /// X-Plane's screen.
    pub magnetic_heading_column: u8,
    /// What a positive axial load in row 4 means, on which sources disagree.
    /// Default: found out in flight, and forwards until then.
    pub axial_load: AxialLoad,
}

/// What a positive axial load in row 4 of Data Output means.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AxialLoad {
    /// Found out from pitch and airspeed, some seconds after the nose is 2° high
    /// or low, or the aircraft changes its speed.
    Auto,
    /// A load forwards, as in an acceleration.
    Forwards,
    /// A load backwards.
    Backwards,
}

impl DataRows {
    /// The layout that most sources give for a version.
    pub const fn of(version: RowsVersion) -> Self {
        Self {
            version,
            magnetic_heading_column: 3,
            axial_load: AxialLoad::Auto,
        }
    }
}

/// A version of X-Plane, as far as the row layout differs.
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

/// How control surfaces are written. The overrides are set by DREF in both
/// cases.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Output {
    /// As datarefs.
    Dref,
    /// As rows 8 (joystick) and 25 (throttles), two rows in one datagram.
    Data,
}

/// Why a configuration is refused.
#[derive(thiserror::Error, Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum XPlaneConfigError {
    /// A number is outside its range.
    #[error("{key} is {value}: choose {range}")]
    Range {
        /// The field.
        key: &'static str,
        /// Its value.
        value: String,
        /// The permitted range.
        range: &'static str,
    },
    /// The engage switch is no dataref path.
    #[error("engage_switch \"{path}\": {source}")]
    EngageSwitch {
        /// Its value.
        path: String,
        /// What is wrong with it.
        source: PathError,
    },
    /// The engage switch is a generic light that no version has.
    #[error(
        "engage_switch \"{path}\": X-Plane has generic lights 0 to {}: choose one that no aircraft \
         uses, such as {}",
        engage_switch::MOST - 1,
        engage_switch::DEFAULT
    )]
    NoSuchLight {
        /// Its value.
        path: String,
    },
    /// An address to which no datagram can be sent.
    #[error("simulator {0}: give the IP address and port of one machine, such as 127.0.0.1:49000")]
    Simulator(SocketAddr),
    /// A link-local address without the network interface.
    #[error(
        "simulator {0} is an address within one network: give the network's interface too, such \
         as [fe80::1%2]:49000, where 2 is its number in `ip link`"
    )]
    NoInterface(SocketAddr),
    /// Everything sent would come back.
    #[error(
        "simulator {0} is the port that is received on here: give X-Plane's port, 49000 unless it \
         was changed, or another local_port"
    )]
    OwnPort(SocketAddr),
    /// Input is by rows, but no port is given to receive them on.
    #[error(
        "input by Data Output needs local_port: the one that is set as the target port in X-Plane"
    )]
    LocalPort,
}

/// Returns an error that names the first value that is out of its range: names,
/// values, least and most, and the range in words.
macro_rules! check {
    ($($key:literal, $value:expr => $least:expr, $most:expr, $range:literal;)+) => {$(
        let value = $value;
        if !($least..=$most).contains(&value) {
            return Err(XPlaneConfigError::Range {
                key: $key,
                value: format!("{value:?}"),
                range: $range,
            });
        }
    )+};
}

impl XPlaneConfig {
    /// Checks that every field is within its range.
    ///
    /// # Errors
    /// The first field that is not, with the permitted range.
    pub fn validate(&self) -> Result<(), XPlaneConfigError> {
        let (ms, second) = (Duration::from_millis, Duration::from_secs(1));
        check! {
            "rate_hz", self.rate_hz => 1, 1_000, "1 to 1000";
            "engines", self.engines => 1, 8, "1 to 8";
            "datagrams_per_tick", self.datagrams_per_tick => 1, 1_000, "1 to 1000";
            "resubscribe", self.resubscribe => ms(100), 3_600 * second, "100 ms to 1 h";
            "silent_after", self.silent_after => ms(50), 60 * second, "50 ms to 1 min";
            "beacon port", self.beacon.port() => 1, u16::MAX, "1 to 65535";
        }
        check_path(&self.engage_switch, rref::PATH_BYTES).map_err(|source| {
            XPlaneConfigError::EngageSwitch {
                path: self.engage_switch.clone(),
                source,
            }
        })?;
        if engage_switch::generic_light(&self.engage_switch)
            .is_some_and(|light| light >= engage_switch::MOST)
        {
            return Err(XPlaneConfigError::NoSuchLight {
                path: self.engage_switch.clone(),
            });
        }
        if let Simulator::At(at) = self.simulator {
            check_address(at)?;
            if at.ip().is_loopback() && at.port() == self.local_port {
                return Err(XPlaneConfigError::OwnPort(at));
            }
        }
        if let Input::Data(rows) = self.input {
            check! {
                "magnetic_heading_column", rows.magnetic_heading_column => 2, 7, "2 to 7";
            }
            if self.local_port == 0 {
                return Err(XPlaneConfigError::LocalPort);
            }
        }
        Ok(())
    }
}

/// Whether this is the address of a single machine to which datagrams can be
/// sent.
pub(crate) fn check_address(address: SocketAddr) -> Result<(), XPlaneConfigError> {
    let ip = address.ip();
    let is_broadcast = matches!(ip, IpAddr::V4(ip) if ip.is_broadcast());
    if address.port() == 0 || ip.is_unspecified() || ip.is_multicast() || is_broadcast {
        return Err(XPlaneConfigError::Simulator(address));
    }
    match address {
        SocketAddr::V6(v6) if v6.ip().is_unicast_link_local() && v6.scope_id() == 0 => {
            Err(XPlaneConfigError::NoInterface(address))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error_text(change: impl FnOnce(&mut XPlaneConfig)) -> String {
        let mut config = XPlaneConfig::default();
        change(&mut config);
        config.validate().unwrap_err().to_string()
    }

    #[test]
    fn the_defaults_are_valid() {
        XPlaneConfig::default().validate().unwrap();
    }

    #[test]
    fn an_error_names_the_field_and_the_permitted_range() {
        assert_eq!(error_text(|c| c.engines = 9), "engines is 9: choose 1 to 8");
        assert_eq!(error_text(|c| c.engines = 0), "engines is 0: choose 1 to 8");
        assert_eq!(
            error_text(|c| c.resubscribe = Duration::from_millis(20)),
            "resubscribe is 20ms: choose 100 ms to 1 h"
        );
        assert_eq!(
            error_text(|c| c.engage_switch = "a".repeat(400)),
            format!(
                "engage_switch \"{}\": the dataref path is 400 bytes long: at most 399 fit",
                "a".repeat(400)
            )
        );
        let beyond = "sim/cockpit2/switches/generic_lights_switch[128]";
        assert!(error_text(|c| c.engage_switch = beyond.into()).contains("lights 0 to 127"));
        assert!(error_text(|c| c.engage_switch.clear()).contains("is empty"));
        assert!(error_text(|c| c.engage_switch = "sim/größe".into()).contains("no dataref has"));
        assert!(error_text(|c| c.engage_switch = "sim/a\0b".into()).contains("no dataref has"));
        let nowhere = (Ipv4Addr::UNSPECIFIED, 49_000).into();
        assert!(error_text(|c| c.simulator = Simulator::At(nowhere)).contains("127.0.0.1:49000"));
        let own = error_text(|c| c.local_port = 49_000);
        assert!(own.contains("simulator 127.0.0.1:49000 is the port that is received on"));
        let rows = Input::Data(DataRows::of(RowsVersion::XPlane12));
        assert!(error_text(|c| c.input = rows).contains("local_port"));
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
