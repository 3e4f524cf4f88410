//! Whether the simulator's ports are still its own: found out outside the loop.
//!
//! While controls are held, another port is adopted in place of one that has
//! become silent only if that one is gone, since any program of the simulator's
//! machine may send:
//!
//! - Of a simulator on this machine the kernel tells the user of each socket.
//!   Only ports of the user who has the port that the simulator listens on are
//!   delivered; a port is gone if it is closed, or another user's.
//! - Another machine reports that a port is closed ([`Probe`]). That counts
//!   unless a port that answers is reported as closed, too: by a firewall.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use crate::address::XPLANE_REPLY_PORT;
use crate::link::SharedState;
use crate::probe::Probe;
use crate::udp_port::is_of_this_machine;
use crate::udp_sockets::UdpSockets;

const LOOK_EVERY: Duration = Duration::from_secs(1);
/// While a port is silent, or none is known.
const LOOK_AGAIN: Duration = Duration::from_millis(200);
/// More ports of one user are not delivered: the kernel limits a filter's size.
pub(crate) const MOST_PORTS: usize = 200;

/// Looks at the ports of the simulator of one connection.
#[derive(Debug, Default)]
pub(crate) struct PortWatch {
    simulator: Option<SocketAddr>,
    looked: Option<Instant>,
    /// Of a simulator on this machine.
    sockets: Option<UdpSockets>,
    /// The user who has the simulator's sockets, if that is known.
    user: Option<u32>,
    /// That user's ports.
    owned: Option<Vec<u16>>,
    probe: Option<ClosedPort>,
}

impl PortWatch {
    /// Looks when it is due, and adapts the kernel's filter; `flown` is the
    /// connection over which is written. Does not wait.
    pub(crate) fn look(&mut self, link: &SharedState, flown: &SharedState) {
        let Some(simulator) = link.address.simulator() else {
            return;
        };
        if self.simulator != Some(simulator) {
            *self = Self {
                simulator: Some(simulator),
                sockets: is_of_this_machine(simulator)
                    .then(|| UdpSockets::sending_from(simulator.ip())),
                ..Self::default()
            };
        }
        let every = if link.is_port_silent() {
            LOOK_AGAIN
        } else {
            LOOK_EVERY
        };
        if self.looked.is_none_or(|at| at.elapsed() >= every) {
            self.look_at_sockets(link, flown.is_held());
            if self.user.is_none() {
                self.probe_port(link, flown.is_held());
            }
            self.looked = Some(Instant::now());
        }
        link.adapt_filter(self.owned.as_deref());
    }

    /// The user who has the simulator's sockets, if it is on this machine.
    pub(crate) const fn user(&self) -> Option<u32> {
        self.user
    }

    fn look_at_sockets(&mut self, link: &SharedState, is_held: bool) {
        let Some((simulator, sockets)) = self.simulator.zip(self.sockets.as_mut()) else {
            return;
        };
        sockets.look();
        if !is_held && let Ok(user) = sockets.user_of(simulator.port()) {
            self.user = user;
        }
        let held = link.held_ports();
        let mut likely = held.to_vec();
        likely.extend([simulator.port(), XPLANE_REPLY_PORT]);
        self.owned = self
            .user
            .map(|user| sockets.ports_of(user, &likely, MOST_PORTS));
        if let Some(user) = self.user {
            let gone = held.map(|port| match sockets.user_of(port) {
                Ok(found) if found != Some(user) => port,
                _ => 0,
            });
            link.set_gone_ports(gone, true);
        } else {
            link.set_gone_ports([0; 4], false);
        }
    }

    fn probe_port(&mut self, link: &SharedState, is_held: bool) {
        let held = link.held_ports();
        let [port, ..] = held;
        let to = self
            .simulator
            .map(|simulator| SocketAddr::new(simulator.ip(), port))
            .filter(|_| is_held && port != 0);
        let Some(to) = to else {
            self.probe = None;
            return;
        };
        if self.probe.as_ref().is_none_or(|probe| probe.to != to) {
            self.probe = ClosedPort::of(to);
        }
        let is_silent = link.is_port_silent();
        let is_closed = self
            .probe
            .as_mut()
            .is_some_and(|probe| probe.is_closed(!is_silent));
        link.set_gone_ports(if is_closed { held } else { [0; 4] }, false);
    }
}

/// Asks the machine of a port whether it is closed.
#[derive(Debug)]
pub(crate) struct ClosedPort {
    to: SocketAddr,
    probe: Probe,
    /// A firewall reports it as closed.
    is_unknown: bool,
    is_closed: bool,
}

impl ClosedPort {
    pub(crate) fn of(to: SocketAddr) -> Option<Self> {
        Some(Self {
            to,
            probe: Probe::of(to).ok()?,
            is_unknown: false,
            is_closed: false,
        })
    }

    /// What was found out by the requests so far; sends another one.
    /// `answers`: whether datagrams come from there.
    pub(crate) fn is_closed(&mut self, answers: bool) -> bool {
        let refused = self.probe.is_refused();
        self.probe.send();
        self.is_unknown |= refused && answers;
        self.is_closed = !answers && !self.is_unknown && (refused || self.is_closed);
        self.is_closed
    }
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;

    use super::*;

    fn closed_within_a_second(asked: &mut ClosedPort, answers: bool) -> bool {
        (0..50).any(|_| {
            std::thread::sleep(Duration::from_millis(20));
            asked.is_closed(answers)
        })
    }

    #[test]
    fn a_port_is_closed_once_its_machine_says_so_and_it_does_not_answer() {
        let simulator = UdpSocket::bind("127.0.0.1:0").unwrap();
        let at = simulator.local_addr().unwrap();
        let mut asked = ClosedPort::of(at).unwrap();
        assert!(!closed_within_a_second(&mut asked, false));
        drop(simulator);
        assert!(closed_within_a_second(&mut asked, false));
        // A firewall says so of a port that answers.
        let mut asked = ClosedPort::of(at).unwrap();
        assert!(!closed_within_a_second(&mut asked, true));
        assert!(!closed_within_a_second(&mut asked, false));
    }
}
