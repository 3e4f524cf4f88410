//! Opening a connection.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4};
use std::sync::Arc;

use crate::actuator::XPlaneActuator;
use crate::address::{HostName, Simulator};
use crate::config::{XPlaneConfig, XPlaneConfigError};
use crate::link::SharedState;
use crate::port::{Port, UdpPort};
use crate::protocol::PathError;
use crate::sensor::XPlaneSensor;

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
    /// The local port cannot be had.
    #[error(
        "cannot receive on UDP port {port}: {source}; choose another local_port, 0 for any that \
         is free (a second program for X-Plane on this machine may have taken it)"
    )]
    Bind {
        /// The port asked for.
        port: u16,
        /// What the operating system said.
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
        /// What the operating system said.
        source: io::Error,
    },
    /// Beacons cannot be listened for.
    #[error(
        "cannot listen for X-Plane's beacon on {group}: {source}; give X-Plane's address instead"
    )]
    Beacon {
        /// The multicast group and port.
        group: SocketAddrV4,
        /// What the operating system said.
        source: io::Error,
    },
}

impl XPlane {
    /// Opens the sockets, and looks up the simulator's host name, which may wait
    /// for the network. Nothing is sent before the first tick, and X-Plane need
    /// not run yet.
    ///
    /// # Errors
    /// When the configuration is refused, the name has no address, or a port
    /// cannot be had.
    pub fn open(config: &XPlaneConfig) -> Result<(XPlaneSensor, XPlaneActuator), OpenError> {
        config.validate()?;
        let simulator = config.simulator.locate()?;
        // Beacons are of IPv4, and so is whom they tell of.
        let peer = simulator.map_or(IpAddr::V4(Ipv4Addr::UNSPECIFIED), |at| at.ip());
        let port = bind(config.local_port, peer)?;
        let beacons = match config.simulator {
            Simulator::At(_) | Simulator::Named(_) => None,
            Simulator::Beacon => {
                let group = config.beacon;
                let listen = UdpPort::listen(group);
                Some(listen.map_err(|source| OpenError::Beacon { group, source })?)
            }
        };
        Self::join(config, simulator, port, beacons)
    }

    /// The same over a port of the caller's own: for tests, and for networks
    /// that are not UDP sockets.
    ///
    /// # Errors
    /// When the configuration is refused, or the name has no address.
    pub fn over<P: Port>(
        config: &XPlaneConfig,
        port: P,
        beacons: Option<P>,
    ) -> Result<(XPlaneSensor<P>, XPlaneActuator<P>), OpenError> {
        config.validate()?;
        Self::join(config, config.simulator.locate()?, port, beacons)
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

fn bind(port: u16, peer: IpAddr) -> Result<UdpPort, OpenError> {
    UdpPort::bind(port, peer).map_err(|source| OpenError::Bind { port, source })
}
