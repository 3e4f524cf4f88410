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
            bytes: 0,
            messages: 0,
        }
    }

    /// Takes what has arrived; whether it is more than anything sends that belongs here.
    pub(crate) fn is_flood(&mut self, bytes: usize, messages: usize) -> bool {
        if self.began.elapsed() >= SECOND {
            *self = Self::begin();
        }
        self.bytes += bytes;
        self.messages += messages;
        self.bytes > Self::MOST_BYTES || self.messages > Self::MOST_MESSAGES
    }
}
