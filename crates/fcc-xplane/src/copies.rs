//! Datagrams that arrive again, long after the first time.
//!
//! A network with two ways doubles some, and delivers the copy late; another program
//! may repeat what it recorded. A time that goes back may also be a flight that was
//! loaded, and a position has no time at all: what tells an old one apart is that it
//! is the same, to the last bit, as one that arrived before the newest.

use core::time::Duration;

use fcc_core::framework::Time;

/// So many are remembered: of 20 s at 100 frames a second, of 100 s of positions.
const REMEMBERED: usize = 2_048;
/// If nothing else arrives for so long, they are no copies: an aircraft is again
/// where it stood.
const ALONE: Duration = Duration::from_secs(2);
/// FNV-1a, 64 bits (Fowler, Noll and Vo).
const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0100_0000_01b3;

/// Remembers the datagrams of one kind, by their hashes.
#[derive(Clone, Debug)]
pub(crate) struct Copies {
    hashes: [u64; REMEMBERED],
    next: usize,
    newest: u64,
    /// When the newest arrived, or arrived again.
    arrived: Time,
}

impl Default for Copies {
    fn default() -> Self {
        Self {
            hashes: [0; REMEMBERED],
            next: 0,
            newest: 0,
            arrived: Time::NEVER,
        }
    }
}

impl Copies {
    /// Whether this is an older one that arrives again; not if it is the newest, as
    /// while nothing moves.
    pub(crate) fn is_old(&mut self, datagram: &[u8], now: Time) -> bool {
        let hash = hash(datagram);
        if hash != self.newest {
            if now.since(self.arrived) < ALONE && self.hashes.contains(&hash) {
                return true;
            }
            self.newest = hash;
            if let Some(place) = self.hashes.get_mut(self.next) {
                *place = hash;
            }
            self.next = (self.next + 1) % REMEMBERED;
        }
        self.arrived = now;
        false
    }
}

fn hash(datagram: &[u8]) -> u64 {
    datagram.iter().fold(OFFSET_BASIS, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(PRIME)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_old_one_is_known_and_what_stands_still_or_stays_is_not_old() {
        let mut copies = Copies::default();
        let at = |tenths: i64| Time::from_nanos(tenths * 100_000_000);
        for number in 0..50_u8 {
            assert!(!copies.is_old(&[number; 60], at(number.into())));
        }
        assert!(copies.is_old(&[7; 60], at(50)));
        assert!(!copies.is_old(&[49; 60], at(68)), "it stands still");
        assert!(copies.is_old(&[7; 60], at(69)));
        assert!(copies.is_old(&[7; 60], at(87)));
        assert!(
            !copies.is_old(&[7; 60], at(88)),
            "two seconds, nothing else"
        );
        assert!(copies.is_old(&[49; 60], at(89)));
    }

    /// Of the authors' test vectors: "foobar", 64 bits of FNV-1a.
    #[test]
    fn the_hash_is_the_published_one() {
        assert_eq!(hash(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
