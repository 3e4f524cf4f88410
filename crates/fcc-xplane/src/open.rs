//! Opening a connection.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4};
use std::sync::Arc;

use crate::actuator::XPlaneActuator;
use crate::address::{HostName, Simulator, USUAL_LOCAL_PORT};
use crate::beacon_group::BeaconGroup;
use crate::config::{XPlaneConfig, XPlaneConfigError, check_address};
use crate::link::SharedState;
use crate::port::Port;
use crate::protocol::PathError;
use crate::sensor::XPlaneSensor;
use crate::udp_port::UdpPort;

/// Opens connections to X-Plane.
#[derive(Clone, Copy, Debug)]
pub struct XPlane;

/// Why a connection could not be opened.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum OpenError {
    /// The configuration is refused.
    #[error(transparent)]
    Config(#[from] XPlaneConfigError),
    /// A dataref's path cannot be sent.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The local port cannot be bound.
    #[error(
        "cannot receive on UDP port {port}: {source}; choose another local_port, 0 for one that \
         is free (a second program for X-Plane on this machine may have taken it)"
    )]
    Bind {
        /// The port asked for.
        port: u16,
        /// The operating system's error.
        source: io::Error,
    },
    /// The simulator's host name has no address.
    #[error(
        "cannot find X-Plane at {host}: {source}; check the name and the network, or give its IP \
         address (a name that ends in .local needs the package libnss-mdns)"
    )]
    NoSuchHost {
        /// The name.
        host: HostName,
        /// The operating system's error.
        source: io::Error,
    },
    /// Beacons cannot be received.
    #[error(
        "cannot listen for X-Plane's beacon on {group}: {source}; give X-Plane's address instead"
    )]
    Beacon {
        /// The multicast group and port.
        group: SocketAddrV4,
        /// The operating system's error.
        source: io::Error,
    },
}

impl XPlane {
    /// Opens the sockets, and looks up the simulator's host name, which may
    /// wait for the network. Nothing is sent before the first tick, and X-Plane
    /// need not be running yet.
    ///
    /// # Errors
    /// When the configuration is refused, the name has no address, or a port
    /// cannot be bound.
    pub fn open(config: &XPlaneConfig) -> Result<(XPlaneSensor, XPlaneActuator), OpenError> {
        config.validate()?;
        let simulator = locate(&config.simulator)?;
        // Beacons are sent over IPv4, so the simulator has an IPv4 address.
        let peer = simulator.map_or(IpAddr::V4(Ipv4Addr::UNSPECIFIED), |at| at.ip());
        let port = bind(&local_ports(config.local_port, peer), |port| {
            UdpPort::bind(port, peer)
        })?;
        let local_port = port.local_port().unwrap_or(0);
        let filter = port.filter().ok();
        let beacons = match config.simulator {
            Simulator::At(_) | Simulator::Named(_) => None,
            Simulator::Beacon => {
                let group = config.beacon;
                let listen = UdpPort::listen(group);
                Some(listen.map_err(|source| OpenError::Beacon { group, source })?)
            }
        };
        let group = beacons
            .as_ref()
            .and_then(|port| BeaconGroup::of(port, config.beacon).ok().flatten());
        let (sensor, actuator) = Self::join(config, simulator, port, beacons)?;
        sensor.set_socket(local_port, filter);
        if let Some(group) = group {
            sensor.set_beacon_group(group);
        }
        Ok((sensor, actuator))
    }

    /// The same over the caller's own [`Port`]: for tests, and for networks
    /// other than UDP sockets.
    ///
    /// # Errors
    /// When the configuration is refused, or the name has no address.
    pub fn over<P: Port>(
        config: &XPlaneConfig,
        port: P,
        beacons: Option<P>,
    ) -> Result<(XPlaneSensor<P>, XPlaneActuator<P>), OpenError> {
        config.validate()?;
        Self::join(config, locate(&config.simulator)?, port, beacons)
    }

    fn join<P: Port>(
        config: &XPlaneConfig,
        simulator: Option<SocketAddr>,
        port: P,
        beacons: Option<P>,
    ) -> Result<(XPlaneSensor<P>, XPlaneActuator<P>), OpenError> {
        let port = Arc::new(port);
        let link = Arc::new(SharedState::new(simulator));
        let sensor = XPlaneSensor::new(config, Arc::clone(&port), beacons, Arc::clone(&link))?;
        let actuator = XPlaneActuator::new(config, port, link)?;
        Ok((sensor, actuator))
    }
}

/// The local ports to try, in this order; 0 stands for any that is free. No
/// firewall is between programs of one machine, so there any will do, and those
/// of several daemons differ.
pub(crate) fn local_ports(configured: u16, peer: IpAddr) -> Vec<u16> {
    match configured {
        0 if peer.is_loopback() => vec![0],
        0 => vec![USUAL_LOCAL_PORT, 0],
        port => vec![port],
    }
}

/// Binds to the first of these ports that no other program has.
pub(crate) fn bind<S>(ports: &[u16], bind: impl Fn(u16) -> io::Result<S>) -> Result<S, OpenError> {
    let mut taken = OpenError::Bind {
        port: 0,
        source: io::ErrorKind::AddrInUse.into(),
    };
    for port in ports.iter().copied() {
        match bind(port) {
            Ok(socket) => return Ok(socket),
            Err(source) if source.kind() == io::ErrorKind::AddrInUse => {
                taken = OpenError::Bind { port, source };
            }
            Err(source) => return Err(OpenError::Bind { port, source }),
        }
    }
    Err(taken)
}

/// Where datagrams are sent; `None` if it is known only from a beacon. A
/// name is looked up, which may wait for the network, so do not call this
/// in a loop.
fn locate(simulator: &Simulator) -> Result<Option<SocketAddr>, OpenError> {
    let address = match simulator {
        Simulator::Beacon => return Ok(None),
        Simulator::At(address) => *address,
        Simulator::Named(host) => host.look_up().map_err(|source| OpenError::NoSuchHost {
            host: host.clone(),
            source,
        })?,
    };
    check_address(address)?;
    Ok(Some(address))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_port_is_used_unless_it_is_taken_or_the_simulator_is_here() {
        let (here, there) = ([127, 0, 0, 1].into(), [192, 0, 2, 1].into());
        assert_eq!(local_ports(0, here), [0]);
        assert_eq!(local_ports(0, there), [USUAL_LOCAL_PORT, 0]);
        assert_eq!(local_ports(5_000, there), [5_000]);
        let taken = |number: u16| {
            move |port: u16| match port {
                port if port == number => Err(io::Error::from(io::ErrorKind::AddrInUse)),
                port => Ok(port),
            }
        };
        let ports = local_ports(0, there);
        assert_eq!(bind(&ports, taken(0)).unwrap(), USUAL_LOCAL_PORT);
        assert_eq!(bind(&ports, taken(USUAL_LOCAL_PORT)).unwrap(), 0);
        let message = bind(&[5_000], taken(5_000)).unwrap_err().to_string();
        assert!(message.contains("UDP port 5000"), "{message}");
    }

    #[test]
    fn a_name_is_looked_up_and_ipv4_comes_first() {
        // Every machine has this name (RFC 6761), most of them for IPv6 too.
        let here: Simulator = "localhost:49000".parse().unwrap();
        let found = locate(&here).unwrap().unwrap();
        assert!(found.is_ipv4() && found.ip().is_loopback(), "{found}");
        // No machine has this name (RFC 6761).
        let nowhere: Simulator = "sim.invalid".parse().unwrap();
        let message = locate(&nowhere).unwrap_err().to_string();
        assert!(message.contains("sim.invalid:49000"), "{message}");
        assert!(message.contains("IP address"), "{message}");
    }

    #[test]
    fn broadcast_multicast_and_unspecified_addresses_are_refused() {
        for text in [
            "0.0.0.0",
            "255.255.255.255",
            "239.1.1.1",
            "[::]",
            "[ff02::1]",
        ] {
            let simulator: Simulator = text.parse().unwrap();
            let message = locate(&simulator).unwrap_err().to_string();
            assert!(message.contains("one machine"), "{message}");
        }
        let somewhere: Simulator = "fe80::1".parse().unwrap();
        let message = locate(&somewhere).unwrap_err().to_string();
        assert!(message.contains("%2]:49000"), "{message}");
        let there = "[fe80::1%2]:49000".parse().unwrap();
        assert!(locate(&there).is_ok());
    }
}
