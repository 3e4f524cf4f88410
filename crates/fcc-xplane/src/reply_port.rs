//! From which of the simulator's ports its datagrams are accepted.
//!
//! X-Plane listens on one port, 49000 unless it was changed, and sends from
//! another, 49001 unless it was changed. The port it sends from is learned from
//! the first datagram that answers a request, and from then on datagrams from
//! other ports of that machine are left out: another program or another X-Plane
//! there could send them.
//!
//! While nothing is held, the next port that answers is used when nothing has
//! come from this one for [`KEPT_FOR`]: X-Plane was started again, and sends from
//! another. The configured port is preferred to one that was learned: X-Plane has
//! it open, so no other program can send from it.
//!
//! While controls are held, another port is used only if this one is
//! [gone](crate::port_watch): X-Plane may stand still for a minute, and its port
//! stays open. Where nobody tells whether it is gone, another one is used once
//! the controls were released and this one has been silent for
//! [`KEPT_FOR_WHILE_HELD`]; it cannot confirm that release, and the port that was
//! flown is used again as soon as it answers.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::protocol::Kind;
use crate::source_filter::Ports;

/// X-Plane takes longer to start, and its freezes are mostly shorter.
const KEPT_FOR: Duration = Duration::from_secs(2);
/// Freezes while scenery is loaded are shorter.
const KEPT_FOR_WHILE_HELD: Duration = Duration::from_secs(30);

/// What is known besides the datagrams.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Situation {
    /// Controls are held, or their release is not confirmed.
    pub(crate) is_held: bool,
    /// They are written in each tick.
    pub(crate) is_written: bool,
    /// The port that answered when they were taken.
    pub(crate) flown: Option<u16>,
    /// Ports that are closed, or another user's.
    pub(crate) gone: Ports,
    /// Other ports are known not to be.
    pub(crate) is_gone_known: bool,
}

impl Situation {
    fn is_gone(&self, port: u16) -> bool {
        self.gone.contains(&port)
    }
}

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
    pub(crate) situation: Situation,
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
            situation: Situation {
                is_held: false,
                is_written: false,
                flown: None,
                gone: [0; 4],
                is_gone_known: false,
            },
        }
    }

    /// Whether a datagram of this kind is accepted from this port.
    pub(crate) fn accepts(&self, kind: Kind, port: u16, now: Time) -> bool {
        let Situation { is_held, flown, .. } = self.situation;
        match self.held(kind) {
            None if is_held => self.known().contains(&port) || self.known() == [0; 4],
            None => !self.left.contains(&Some(port)),
            Some(held) => {
                held.port == port
                    || (is_held && flown == Some(port))
                    || (!is_held && port == self.expected)
                    || self.may_leave(held, now)
            }
        }
    }

    /// Whether another port may take the place of this one.
    fn may_leave(&self, held: Held, now: Time) -> bool {
        let silent = now.since(held.last);
        match self.situation {
            Situation { is_held: false, .. } => silent > KEPT_FOR,
            known if known.is_gone(held.port) => true,
            known => !known.is_gone_known && !known.is_written && silent > KEPT_FOR_WHILE_HELD,
        }
    }

    /// The ports in use, of replies first; 0 for none.
    pub(crate) fn known(&self) -> Ports {
        let [replies, positions, rows] = self.held.map(|held| held.map_or(0, |held| held.port));
        [replies, positions, rows, 0]
    }

    /// Whether nothing comes from one of them any more, or none is known of a
    /// kind that is expected.
    pub(crate) fn is_silent(&self, now: Time) -> bool {
        let mut kinds = self.held.iter().zip(self.needed);
        kinds.any(|(held, needed)| held.map_or(needed, |held| now.since(held.last) > KEPT_FOR))
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
        let Situation { is_held, flown, .. } = self.situation;
        let preferred = if is_held { flown } else { Some(self.expected) };
        let mut ports = [0, 0, 0, preferred.unwrap_or_default()];
        for ((port, held), needed) in ports.iter_mut().zip(self.held).zip(self.needed) {
            match held.filter(|held| !self.may_leave(*held, now)) {
                Some(held) => *port = held.port,
                // From the port of another kind.
                None if needed && !(is_held && held.is_none()) => return [0; 4],
                None => {}
            }
        }
        ports
    }

    /// A datagram that was accepted was requested, and whole. Returns whether it
    /// comes from the simulator started again while its controls are held.
    pub(crate) fn hold(&mut self, kind: Kind, port: u16, now: Time) -> bool {
        let situation = self.situation;
        let Some(held) = place(kind).and_then(|place| self.held.get_mut(place)) else {
            return false;
        };
        let before = held.replace(Held { port, last: now });
        situation.is_held
            && before.is_some_and(|before| before.port != port && situation.is_gone(before.port))
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

    const HELD: Situation = Situation {
        is_held: true,
        is_written: true,
        flown: Some(49_005),
        gone: [0; 4],
        is_gone_known: false,
    };

    /// In flight, all from 49005.
    fn flown() -> ReplyPorts {
        let mut ports = ReplyPorts::new(49_001, false);
        ports.hold(Kind::Rref, 49_005, after_ms(0));
        ports.hold(Kind::Rpos, 49_005, after_ms(0));
        ports.situation = HELD;
        ports
    }

    #[test]
    fn while_controls_are_held_no_other_port_is_accepted_however_long_it_is_silent() {
        let ports = flown();
        for ms in [1, 2_500, 60_000, 3_600_000] {
            for other in [49_001, 50_000] {
                assert!(!ports.accepts(Kind::Rref, other, after_ms(ms)), "{ms}");
            }
            assert!(ports.accepts(Kind::Rref, 49_005, after_ms(ms)));
            assert_eq!(ports.to_deliver(after_ms(ms)), [49_005, 49_005, 0, 49_005]);
        }
    }

    #[test]
    fn while_controls_are_held_a_kind_that_was_missing_comes_from_a_known_port() {
        let mut ports = ReplyPorts::new(49_001, false);
        ports.hold(Kind::Rref, 49_005, after_ms(0));
        ports.situation = HELD;
        assert!(!ports.accepts(Kind::Rpos, 50_000, after_ms(1)));
        assert!(ports.accepts(Kind::Rpos, 49_005, after_ms(1)));
        assert_eq!(ports.to_deliver(after_ms(1)), [49_005, 0, 0, 49_005]);
    }

    #[test]
    fn a_port_that_is_gone_is_left_at_once_and_the_next_one_is_flown() {
        let mut ports = flown();
        ports.situation.gone = [49_005, 49_005, 0, 0];
        assert_eq!(ports.to_deliver(after_ms(500)), [0; 4]);
        assert!(ports.accepts(Kind::Rref, 49_006, after_ms(500)));
        assert!(ports.hold(Kind::Rref, 49_006, after_ms(500)));
        assert!(!ports.accepts(Kind::Rref, 49_007, after_ms(501)));
        // The same, in the next datagram.
        assert!(!ports.hold(Kind::Rref, 49_006, after_ms(510)));
    }

    #[test]
    fn where_nobody_tells_it_is_left_after_the_release_and_half_a_minute() {
        let mut ports = flown();
        ports.situation.is_written = false;
        assert!(!ports.accepts(Kind::Rref, 49_006, after_ms(29_900)));
        assert!(ports.accepts(Kind::Rref, 49_006, after_ms(30_100)));
        // Not where the port is known to be open.
        ports.situation.is_gone_known = true;
        assert!(!ports.accepts(Kind::Rref, 49_006, after_ms(60_000)));
        ports.situation.is_gone_known = false;
        assert!(
            !ports.hold(Kind::Rref, 49_006, after_ms(30_100)),
            "no proof"
        );
        // It returns.
        assert!(ports.accepts(Kind::Rref, 49_005, after_ms(30_200)));
        ports.hold(Kind::Rref, 49_005, after_ms(30_200));
        assert!(!ports.accepts(Kind::Rref, 49_006, after_ms(30_300)));
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
