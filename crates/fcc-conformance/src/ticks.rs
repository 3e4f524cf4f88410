//! A clock of ticks without real time.

use std::time::Duration;

use fcc_core::framework::{Tick, Time};

const PERIOD: Duration = Duration::from_millis(25);

/// Ticks at 40 Hz on a computed clock: minutes pass in milliseconds, and
/// nothing depends on the machine's speed.
#[derive(Clone, Copy, Debug)]
pub struct Ticks {
    number: u64,
    now: Time,
}

impl Default for Ticks {
    fn default() -> Self {
        Self {
            number: 0,
            now: Time::from_nanos(1_000_000_000_000),
        }
    }
}

impl Ticks {
    /// The next tick, on time.
    pub fn next_tick(&mut self) -> Tick {
        self.next_after(0)
    }

    /// The next tick after so many missed ones.
    pub fn next_after(&mut self, missed: u32) -> Tick {
        self.number += 1 + u64::from(missed);
        self.now = self.now + PERIOD * (1 + missed);
        Tick {
            number: self.number,
            scheduled: self.now,
            woke: self.now + Duration::from_micros(50),
            missed: u64::from(missed),
            dt_s: PERIOD.as_secs_f64() * f64::from(1 + missed),
        }
    }
}
