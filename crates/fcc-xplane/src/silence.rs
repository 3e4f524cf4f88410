//! Why X-Plane is silent: whether it does not hear us, or we do not hear it.
//!
//! Found out outside the loop, and only while X-Plane is silent. A request
//! without effect is sent from a connected socket each second: to such a socket
//! the kernel reports that no program listens there (ICMP port unreachable), or
//! that no route leads there. Beacons are received, and the sensor counts the
//! other datagrams of that machine.

use std::io::ErrorKind;
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use nix::sys::socket::setsockopt;
use nix::sys::socket::sockopt::{Ipv4RecvErr, Ipv6RecvErr};

use crate::config::XPlaneConfig;
use crate::no_answer::Why;
use crate::protocol::{beacon, rref};
use crate::status::XPlaneStatus;
use crate::udp_port::{UdpPort, is_of_this_machine, local_address};

const PROBE_EVERY: Duration = Duration::from_secs(1);
/// Then another socket is used, since a socket keeps its reports of errors in
/// its receive buffer. The resolution of an absent address takes 3 s.
const PROBES_PER_SOCKET: u32 = 5;
/// More than arrive between two calls.
const BEACONS_PER_CALL: usize = 16;
/// Longer than a beacon.
const BEACON_BYTES: usize = 1_024;
/// Of the request without effect, distinct from those of a sensor and of a
/// release.
const INDEX: i32 = 9_004;

/// Collects what is known about a silence.
#[derive(Debug)]
pub(crate) struct Silence {
    simulator: SocketAddr,
    had_answered: bool,
    received_before: u64,
    request: [u8; rref::REQUEST_BYTES],
    probe: Option<UdpSocket>,
    probes: u32,
    probed: Option<Instant>,
    /// What the last probe was answered with, and whether it was this probe.
    refusal: Option<Why>,
    refused_again: bool,
    beacons: Option<UdpPort>,
    announced: Option<u16>,
}

impl Silence {
    pub(crate) fn begin(
        config: &XPlaneConfig,
        status: &XPlaneStatus,
        simulator: SocketAddr,
    ) -> Self {
        let group = Some(config.beacon).filter(|group| group.ip().is_multicast());
        Self {
            simulator,
            had_answered: status.reply_port().is_some(),
            received_before: status.counts().received,
            request: without_effect(INDEX),
            probe: None,
            probes: 0,
            probed: None,
            refusal: None,
            refused_again: false,
            beacons: group.and_then(|group| UdpPort::listen(group).ok()),
            announced: None,
        }
    }

    /// What is known now. Does not wait.
    pub(crate) fn look(&mut self, status: &XPlaneStatus) -> Why {
        self.read_beacons();
        self.probe();
        let own = self.simulator.port();
        // If one answered here before, another port is that of another X-Plane.
        let announced = self.announced;
        let announced = announced.filter(|port| *port == own || !self.had_answered);
        match (announced, self.refusal) {
            (Some(port), _) if port != own => Why::Announced(port),
            (_, Some(refusal)) => refusal,
            (Some(port), None) => Why::Announced(port),
            _ if self.had_answered => Why::Stopped,
            _ if status.counts().received > self.received_before => Why::DoesNotHear,
            _ => Why::NothingArrives,
        }
    }

    fn read_beacons(&mut self) {
        let mut buffer = [0; BEACON_BYTES];
        for _ in 0..BEACONS_PER_CALL {
            let received = self.beacons.as_ref().map(|port| {
                let socket = port.socket();
                socket.recv_from(&mut buffer)
            });
            let Some(Ok((length, from))) = received else {
                return;
            };
            let datagram = buffer.get(..length).unwrap_or_default();
            let is_there = from.ip() == self.simulator.ip()
                || (self.simulator.ip().is_loopback() && is_of_this_machine(from));
            if let Ok(beacon) = beacon::parse(datagram)
                && beacon.is_flyable()
                && is_there
            {
                self.announced = Some(beacon.port);
            }
        }
    }

    fn probe(&mut self) {
        if let Some(probe) = &self.probe
            && let Ok(Some(error)) = probe.take_error()
        {
            self.take_refusal(error.kind());
        }
        if self.probed.is_some_and(|at| at.elapsed() < PROBE_EVERY) {
            return;
        }
        self.probed = Some(Instant::now());
        if !std::mem::take(&mut self.refused_again) {
            self.refusal = None;
        }
        if self.probes.is_multiple_of(PROBES_PER_SOCKET) {
            self.probe = open_probe(self.simulator).ok();
        }
        self.probes = self.probes.wrapping_add(1);
        let sent = self.probe.as_ref().map(|probe| probe.send(&self.request));
        if let Some(Err(error)) = sent {
            self.take_refusal(error.kind());
        }
    }

    fn take_refusal(&mut self, kind: ErrorKind) {
        let why = match kind {
            ErrorKind::ConnectionRefused => Why::PortClosed,
            ErrorKind::HostUnreachable | ErrorKind::NetworkUnreachable => Why::NoRoute,
            _ => return,
        };
        self.refusal = Some(why);
        self.refused_again = true;
    }
}

/// A request that ends what was not requested.
pub(crate) fn without_effect(index: i32) -> [u8; rref::REQUEST_BYTES] {
    let mut request = [0; rref::REQUEST_BYTES];
    // The path is a valid one.
    let _ = rref::request(&mut request, 0, index, "sim/time/paused");
    request
}

/// Whether the machine there reported that no program has the port.
pub(crate) fn is_refused(error: &std::io::Error) -> bool {
    error.kind() == ErrorKind::ConnectionRefused
}

/// A socket to which the kernel reports what is wrong with this port.
pub(crate) fn open_probe(simulator: SocketAddr) -> std::io::Result<UdpSocket> {
    let probe = UdpSocket::bind((local_address(simulator.ip()), 0))?;
    probe.set_nonblocking(true)?;
    // Without it, only a closed port is reported, and no absent machine.
    let _ = match simulator {
        SocketAddr::V4(_) => setsockopt(&probe, Ipv4RecvErr, &true),
        SocketAddr::V6(_) => setsockopt(&probe, Ipv6RecvErr, &true),
    };
    probe.connect(simulator)?;
    Ok(probe)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open::XPlane;

    /// Looks until something is known, for at most ten seconds.
    fn found(silence: &mut Silence, status: &XPlaneStatus) -> Why {
        let began = Instant::now();
        loop {
            let why = silence.look(status);
            if why != Why::NothingArrives || began.elapsed() > Duration::from_secs(10) {
                return why;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn a_closed_port_is_distinguished_from_one_where_a_program_does_not_answer() {
        for host in ["127.0.0.1", "[::1]"] {
            let other = UdpSocket::bind(format!("{host}:0")).unwrap();
            let simulator = other.local_addr().unwrap();
            let config = XPlaneConfig {
                simulator: crate::Simulator::At(simulator),
                ..XPlaneConfig::default()
            };
            let (sensor, _actuator) = XPlane::open(&config).unwrap();
            let status = sensor.status();
            let mut silence = Silence::begin(&config, &status, simulator);
            // Beacons of other simulators on this machine do not matter here.
            silence.beacons = None;
            assert_eq!(silence.look(&status), Why::NothingArrives);
            drop(other);
            assert_eq!(found(&mut silence, &status), Why::PortClosed, "{host}");
        }
    }

    #[test]
    fn a_beacon_contains_the_port_on_which_it_listens() {
        let group = UdpSocket::bind("127.0.0.1:0").unwrap();
        let config = XPlaneConfig::default();
        let (sensor, _actuator) = XPlane::open(&config).unwrap();
        let status = sensor.status();
        let at = "127.0.0.1:49000".parse().unwrap();
        let mut silence = Silence::begin(&config, &status, at);
        let SocketAddr::V4(there) = group.local_addr().unwrap() else {
            panic!("IPv4");
        };
        drop(group);
        silence.beacons = Some(UdpPort::listen(there).unwrap());
        // Typed from the layout: 11.55, a master, port 49010.
        let mut beacon = b"BECN\0\x01\x02\x01\0\0\0\x2d\xc3\x01\0\x01\0\0\0".to_vec();
        beacon.extend(49_010_u16.to_le_bytes());
        beacon.extend(b"cockpit\0");
        let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
        sender.send_to(&beacon, there).unwrap();
        assert_eq!(silence.look(&status), Why::Announced(49_010));
        // Another X-Plane on that machine, if this one answered before.
        silence.had_answered = true;
        (silence.probe, silence.refusal) = (None, None);
        silence.probed = Some(Instant::now());
        assert_eq!(silence.look(&status), Why::Stopped);
        silence.refusal = Some(Why::PortClosed);
        assert_eq!(silence.look(&status), Why::PortClosed);
    }
}
