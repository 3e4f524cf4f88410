//! Simulators that are found by their beacons.

use std::net::SocketAddr;
use std::time::Duration;

use fcc_core::framework::Time;

use super::XPlaneSensor;
use crate::counters::count;
use crate::port::Port;
use crate::protocol::beacon;

/// X-Plane sends about one beacon a second.
const BEACONS_PER_TICK: usize = 4;
/// A simulator that was chosen has this long to answer before another beacon is
/// followed: one that announces itself much more often, and does not answer,
/// leaves the others their turn.
const ANSWERS_WITHIN: Duration = Duration::from_secs(2);

impl<P: Port> XPlaneSensor<P> {
    /// Reads beacons: connects to the first simulator that computes a flight, and
    /// keeps to it while it sends, and until the release of its controls is
    /// confirmed.
    pub(super) fn listen_for_beacons(&mut self, now: Time) {
        let Some(beacons) = &self.beacons else {
            return;
        };
        let silent = now.since(self.inbox.last_received()) > self.silent_after;
        let waits = silent && self.link.is_held();
        if !waits {
            self.link.forget_announced();
        }
        let may_leave = silent && now.since(self.chosen) > ANSWERS_WITHIN;
        let mut next = None;
        for _ in 0..BEACONS_PER_TICK {
            let Ok(Some((length, from))) = beacons.receive(self.buffer.as_mut_slice()) else {
                break;
            };
            let datagram = self.buffer.get(..length).unwrap_or_default();
            let Ok(beacon) = beacon::parse(datagram) else {
                count(&self.link.counters.malformed);
                continue;
            };
            let known = self.link.address.simulator();
            let address = SocketAddr::new(from.ip(), beacon.port);
            if !beacon.is_flyable() || known == Some(address) {
                continue;
            }
            match known {
                None => {
                    self.chosen = now;
                    self.link.address.set_simulator(address);
                }
                // It may hang, and return with its controls held.
                Some(_) if waits => self.link.set_announced(address),
                Some(known) if may_leave => next = Some((known, address)),
                Some(_) => {}
            }
        }
        if let Some((known, other)) = next {
            self.chosen = now;
            self.leave(known, other);
        }
    }

    /// Another simulator takes the place of one that is silent. What that one
    /// sends later is not the other's.
    fn leave(&mut self, known: SocketAddr, other: SocketAddr) {
        self.subscriptions.end(|request| {
            // If it is lost, that one's datagrams are left out.
            let _ = self.port.send(request, known);
        });
        self.reply_ports.leave(known.ip() == other.ip());
        self.inbox.leave();
        self.link.change_simulator(other);
    }
}
