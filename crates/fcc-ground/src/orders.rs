//! Numbers and deadlines of commands: each once, and in time.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Deserialize;

use crate::failure::Failure;

/// A command may be sent so long before its deadline at most.
const LONGEST_MS: u64 = 60_000;
/// Numbers that are remembered: those of a minute.
const MOST_NUMBERS: usize = 10_000;

/// ms since 1970, UTC.
pub(crate) fn utc_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_millis() as u64)
}

/// The commands of the last minute, and who may send one now.
#[derive(Debug, Default)]
pub(crate) struct Orders {
    numbers: Mutex<BTreeMap<u64, u64>>,
    /// Held while a command is sent: one at a time.
    pub(crate) turn: Mutex<()>,
    /// The system number of the MAVLink station that has taken control; 0: none.
    pub(crate) mavlink_owner: AtomicU8,
}

/// A command's number and the time until which it may be carried out.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(crate) struct Order {
    pub(crate) number: u64,
    pub(crate) deadline_ms_utc: u64,
}

impl Order {
    /// # Errors
    /// When the time is over.
    pub(crate) fn in_time(self, now_ms: u64) -> Result<(), Failure> {
        if now_ms > self.deadline_ms_utc {
            let late_ms = now_ms - self.deadline_ms_utc;
            return Err(Failure::refused(format!(
                "it arrived {late_ms} ms after its deadline: look at the aircraft, and send it again"
            )));
        }
        Ok(())
    }
}

impl Orders {
    /// Whether a page may command.
    ///
    /// # Errors
    /// When a MAVLink station has taken control.
    pub(crate) fn permit_page(&self) -> Result<(), Failure> {
        match self.mavlink_owner.load(Ordering::Acquire) {
            0 => Ok(()),
            owner => Err(Failure::refused(format!(
                "the MAVLink station with system number {owner} is in control: release it there"
            ))),
        }
    }

    /// Takes a number, which is never taken again.
    ///
    /// # Errors
    /// When it is late, or was taken before.
    pub(crate) fn take(&self, order: Order, now_ms: u64) -> Result<(), Failure> {
        order.in_time(now_ms)?;
        if order.deadline_ms_utc - now_ms > LONGEST_MS {
            return Err(Failure::refused(format!(
                "its deadline is more than {} s from now: set the clock of one of both machines",
                LONGEST_MS / 1_000
            )));
        }
        let mut numbers = self.numbers.lock().unwrap_or_else(PoisonError::into_inner);
        // A repeated one is late from then on.
        numbers.retain(|_, deadline_ms| *deadline_ms >= now_ms);
        if numbers.contains_key(&order.number) {
            return Err(Failure::refused(
                "its number was used before: it is not carried out twice",
            ));
        }
        if numbers.len() >= MOST_NUMBERS {
            return Err(Failure::refused("too many commands in a minute: wait"));
        }
        numbers.insert(order.number, order.deadline_ms_utc);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_taken_once_and_in_time() {
        let orders = Orders::default();
        let take = |number, deadline_ms_utc, now_ms| {
            let order = Order {
                number,
                deadline_ms_utc,
            };
            orders.take(order, now_ms).is_ok()
        };
        assert!(take(1, 5_000, 4_000));
        assert!(!take(1, 5_000, 4_001), "repeated");
        assert!(!take(1, 6_000, 4_002), "repeated with another deadline");
        assert!(!take(2, 3_999, 4_003), "late");
        assert!(!take(3, 70_000, 4_004), "far in the future");
        assert!(take(4, 64_000, 4_005));
        // Its first deadline is over, and so is what was recorded of it.
        assert!(!take(1, 5_000, 5_001), "repeated and late");
        assert!(take(5, 5_001, 5_001), "at its deadline");
    }

    #[test]
    fn commands_that_are_remembered_are_not_crowded_out() {
        let orders = Orders::default();
        let take = |number, now_ms| {
            let deadline_ms_utc = now_ms + LONGEST_MS;
            let order = Order {
                number,
                deadline_ms_utc,
            };
            orders.take(order, now_ms).is_ok()
        };
        let most = MOST_NUMBERS as u64;
        assert!((0..most).all(|number| take(number, 1_000)));
        assert!(!take(most, 1_001), "one more than are remembered");
        assert!(!take(0, 1_002), "the first one again");
        assert!(take(most, 1_001 + LONGEST_MS), "a minute later");
    }
}
