//! From which of the simulator's ports its datagrams are accepted.
//!
//! X-Plane listens on one port, 49000 unless it was changed, and sends from
//! another, 49001 unless it was changed. The port it sends from is learned from
//! the first datagram that answers a request, and from then on datagrams from
//! other ports of that machine are left out: another program or another X-Plane
//! there could send them. When nothing has come from this port for
//! [`KEPT_FOR`], the next port that answers is used: X-Plane was started again,
//! and sends from another. The configured port is preferred to one that was
//! learned: X-Plane has it open, so no other program can send from it.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::protocol::Kind;
use crate::source_filter::Ports;

/// X-Plane takes longer to start, and its freezes are mostly shorter.
const KEPT_FOR: Duration = Duration::from_secs(2);

#[derive(Clone, Copy, Debug)]
struct Held {
    port: u16,
    last: Time,
}

/// The ports in use. Replies and rows of Data Output are told apart: no source
/// says that both come from one port in every version.
#[derive(Clone, Debug)]
pub(crate) struct ReplyPorts {
    held: [Option<Held>; 3],
    /// The port from which X-Plane is expected to answer; 0 if that is not
    /// known.
    expected: u16,
    /// Whether a datagram of each kind is expected.
    needed: [bool; 3],
    /// The ports of another simulator at the same address that was left: not
    /// accepted until this one has answered from one of its own.
    left: [Option<u16>; 3],
}

const fn place(kind: Kind) -> Option<usize> {
    match kind {
        Kind::Rref => Some(0),
        Kind::Rpos => Some(1),
        Kind::Data => Some(2),
        Kind::Beacon => None,
    }
}

impl ReplyPorts {
    /// With the port that is expected, 0 if that is not known; whether rows of
    /// Data Output are read in place of the position.
    pub(crate) const fn new(expected: u16, with_rows: bool) -> Self {
        Self {
            held: [None; 3],
            expected,
            needed: [true, !with_rows, with_rows],
            left: [None; 3],
        }
    }

    /// Whether a datagram of this kind is accepted from this port.
    pub(crate) fn accepts(&self, kind: Kind, port: u16, now: Time) -> bool {
        match self.held(kind) {
            None => !self.left.contains(&Some(port)),
            Some(held) => {
                held.port == port || port == self.expected || now.since(held.last) > KEPT_FOR
            }
        }
    }

    /// Forgets the ports of a simulator that was left for another one.
    pub(crate) fn leave(&mut self, is_at_same_address: bool) {
        self.left = [None; 3];
        if is_at_same_address {
            self.left = self.held.map(|held| held.map(|held| held.port));
        }
        if self.left.contains(&Some(self.expected)) {
            self.expected = 0;
        }
        self.held = [None; 3];
    }

    /// The ports from which anything is accepted; all 0 as long as it may come
    /// from another.
    pub(crate) fn to_deliver(&self, now: Time) -> Ports {
        let mut ports = [0, 0, 0, self.expected];
        for ((port, held), needed) in ports.iter_mut().zip(self.held).zip(self.needed) {
            match held.filter(|held| now.since(held.last) <= KEPT_FOR) {
                Some(held) => *port = held.port,
                None if needed => return [0; 4],
                None => {}
            }
        }
        ports
    }

    /// A datagram that was accepted was requested, and whole.
    pub(crate) fn hold(&mut self, kind: Kind, port: u16, now: Time) {
        if let Some(held) = place(kind).and_then(|place| self.held.get_mut(place)) {
            *held = Some(Held { port, last: now });
        }
    }

    fn held(&self, kind: Kind) -> Option<Held> {
        *self.held.get(place(kind)?)?
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after_ms(ms: i64) -> Time {
        Time::from_nanos(1_000_000_000 + ms * 1_000_000)
    }

    #[test]
    fn the_first_port_is_kept_until_it_has_been_silent() {
        let mut ports = ReplyPorts::new(0, false);
        assert!(ports.accepts(Kind::Rref, 49_001, after_ms(0)));
        ports.hold(Kind::Rref, 49_001, after_ms(0));
        for ms in (0..60_000).step_by(1_900) {
            assert!(!ports.accepts(Kind::Rref, 49_003, after_ms(ms)), "{ms}");
            ports.hold(Kind::Rref, 49_001, after_ms(ms));
        }
        assert!(!ports.accepts(Kind::Rref, 49_003, after_ms(60_800)));
        assert!(ports.accepts(Kind::Rref, 49_003, after_ms(63_000)));
        ports.hold(Kind::Rref, 49_003, after_ms(63_000));
        assert!(!ports.accepts(Kind::Rref, 49_001, after_ms(63_001)));
    }

    #[test]
    fn rows_may_come_from_another_port_than_replies() {
        let mut ports = ReplyPorts::new(0, false);
        ports.hold(Kind::Rref, 49_000, after_ms(0));
        assert!(ports.accepts(Kind::Data, 49_001, after_ms(1)));
        assert!(ports.accepts(Kind::Beacon, 49_707, after_ms(1)));
    }

    #[test]
    fn the_expected_port_is_preferred_to_one_that_was_learned() {
        let mut ports = ReplyPorts::new(49_001, false);
        ports.hold(Kind::Rref, 50_000, after_ms(0));
        assert!(!ports.accepts(Kind::Rref, 50_001, after_ms(1)));
        assert!(ports.accepts(Kind::Rref, 49_001, after_ms(1)));
        ports.hold(Kind::Rref, 49_001, after_ms(1));
        assert!(!ports.accepts(Kind::Rref, 50_000, after_ms(2)));
    }

    #[test]
    fn other_ports_are_not_delivered_once_all_kinds_have_arrived() {
        let mut ports = ReplyPorts::new(49_001, false);
        assert_eq!(ports.to_deliver(after_ms(0)), [0; 4]);
        ports.hold(Kind::Rref, 49_005, after_ms(0));
        assert_eq!(ports.to_deliver(after_ms(0)), [0; 4]);
        ports.hold(Kind::Rpos, 49_006, after_ms(1_000));
        assert_eq!(
            ports.to_deliver(after_ms(2_000)),
            [49_005, 49_006, 0, 49_001]
        );
        assert_eq!(ports.to_deliver(after_ms(2_001)), [0; 4]);
        let mut ports = ReplyPorts::new(0, true);
        ports.hold(Kind::Rref, 49_005, after_ms(0));
        ports.hold(Kind::Data, 49_006, after_ms(0));
        assert_eq!(ports.to_deliver(after_ms(1)), [49_005, 0, 49_006, 0]);
    }
}
