//! Why X-Plane is silent: whether it does not hear us, or we do not hear it.
//!
//! Found out outside the loop, and only while X-Plane is silent. A request
//! without effect is sent each second: the simulator's machine reports that no
//! program listens there, or another one that no route leads there. Beacons are received, and the sensor counts the
//! other datagrams of that machine.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use crate::config::XPlaneConfig;
use crate::no_answer::Why;
use crate::probe::{Probe, Report, unreachable};
use crate::protocol::beacon;
use crate::status::XPlaneStatus;
use crate::udp_port::{UdpPort, is_of_this_machine};

const PROBE_EVERY: Duration = Duration::from_secs(1);
/// More than arrive between two calls.
const BEACONS_PER_CALL: usize = 16;
/// Longer than a beacon.
const BEACON_BYTES: usize = 1_024;

/// Collects what is known about a silence.
#[derive(Debug)]
pub(crate) struct Silence {
    simulator: SocketAddr,
    had_answered: bool,
    received_before: u64,
    probe: Option<Probe>,
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
            probe: None,
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
        if let Some(report) = self.probe.as_ref().and_then(Probe::reported) {
            self.refusal = Some(match report {
                Report::Closed => Why::PortClosed,
                Report::Unreachable(errno) => Why::Unreachable(errno),
            });
            self.refused_again = true;
        }
        if self.probed.is_some_and(|at| at.elapsed() < PROBE_EVERY) {
            return;
        }
        self.probed = Some(Instant::now());
        if !std::mem::take(&mut self.refused_again) {
            self.refusal = None;
        }
        let mut unsent = None;
        if self.probe.is_none() {
            match Probe::of(self.simulator) {
                Ok(probe) => self.probe = Some(probe),
                Err(error) => unsent = unreachable(&error),
            }
        }
        let unsent = unsent.or_else(|| self.probe.as_ref()?.send());
        if let Some(errno) = unsent {
            self.refusal = Some(Why::Unreachable(errno));
            self.refused_again = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;

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

    /// To everyone nothing may be sent, unless a program asks for it: EACCES, 13 (ip(7),
    /// errno(3)).
    #[test]
    fn what_the_system_says_when_nothing_can_be_sent_is_known() {
        let (sensor, _actuator) = XPlane::open(&XPlaneConfig::default()).unwrap();
        let status = sensor.status();
        let everyone = "255.255.255.255:49000".parse().unwrap();
        let mut silence = Silence::begin(&XPlaneConfig::default(), &status, everyone);
        silence.beacons = None;
        assert_eq!(silence.look(&status), Why::Unreachable(13));
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
