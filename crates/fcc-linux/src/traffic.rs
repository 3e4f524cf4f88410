//! How much another program or a device sends.
//!
//! What sends without end is not what it is taken for, and would keep the thread that
//! reads it busy: it is closed, and opened again after a pause.

use core::time::Duration;
use std::time::Instant;

const SECOND: Duration = Duration::from_secs(1);

/// Counts what arrives in a second.
#[derive(Debug)]
pub(crate) struct Traffic {
    began: Instant,
    /// Of how many seconds this one's may be: after a stop of this process all comes
    /// at once that was sent meanwhile.
    of_seconds: usize,
    bytes: usize,
    messages: usize,
}

impl Traffic {
    /// In a second. The fastest line that a configuration may have, 4,000,000 baud,
    /// carries 400,000; gpsd gives 500,000 of a receiver with 25 fixes a second, each
    /// with a list of satellites of 15 kB and 5 kB of other reports.
    pub(crate) const MOST_BYTES: usize = 1_000_000;
    /// In a second. Four receivers with 25 fixes a second, each with five reports, are
    /// half of this.
    pub(crate) const MOST_MESSAGES: usize = 1_000;

    pub(crate) fn begin() -> Self {
        Self {
            began: Instant::now(),
            of_seconds: 1,
            bytes: 0,
            messages: 0,
        }
    }

    /// Takes what has arrived; whether it is more than anything sends that belongs here.
    pub(crate) fn is_flood(&mut self, bytes: usize, messages: usize) -> bool {
        let passed = self.began.elapsed();
        if passed >= SECOND {
            *self = Self {
                of_seconds: 1 + passed.as_secs() as usize,
                ..Self::begin()
            };
        }
        self.bytes += bytes;
        self.messages += messages;
        self.bytes > self.of_seconds * Self::MOST_BYTES
            || self.messages > self.of_seconds * Self::MOST_MESSAGES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_sent_during_a_stop_is_no_flood() {
        let mut traffic = Traffic::begin();
        assert!(!traffic.is_flood(400_000, 500));
        assert!(traffic.is_flood(700_000, 0));
        traffic.began = Instant::now().checked_sub(10 * SECOND).unwrap();
        assert!(!traffic.is_flood(5_000_000, 5_000));
        assert!(traffic.is_flood(7_000_000, 0));
    }
}
