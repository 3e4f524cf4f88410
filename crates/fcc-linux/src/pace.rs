//! When the next sample is due.

use core::time::Duration;
use std::thread;
use std::time::Instant;

use crate::WAIT;

/// Waits from sample to sample, without drift.
#[derive(Debug)]
pub(crate) struct Pace {
    period: Duration,
    next: Instant,
}

impl Pace {
    pub(crate) fn new(rate_hz: f64) -> Self {
        Self {
            period: Duration::try_from_secs_f64(1.0 / rate_hz).unwrap_or(WAIT),
            next: Instant::now(),
        }
    }

    /// Waits for the next sample, but no longer than [`WAIT`]; whether it is due.
    pub(crate) fn wait(&mut self) -> bool {
        let now = Instant::now();
        let left = self.next.saturating_duration_since(now);
        if left > WAIT {
            thread::sleep(WAIT);
            return false;
        }
        thread::sleep(left);
        // After a delay the missed ones are left out.
        self.next = (self.next + self.period).max(now);
        true
    }
}
