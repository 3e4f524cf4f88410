//! How often a thread of the flight is started again after it has ended.

use std::time::{Duration, Instant};

/// It is started again this often.
const TIMES: u32 = 5;
/// Not before it has run for so long: one that ends at once would be started in
/// every poll.
const RUNS_AT_LEAST: Duration = Duration::from_secs(1);

/// The starts that a thread has left.
#[derive(Debug)]
pub(super) struct StartsLeft {
    left: u32,
    started: Instant,
}

impl StartsLeft {
    /// It is started now.
    pub(super) fn new() -> Self {
        Self {
            left: TIMES,
            started: Instant::now(),
        }
    }

    /// Whether to start it again now, which then counts. `None` if never again.
    pub(super) fn take(&mut self) -> Option<bool> {
        if self.left == 0 {
            return None;
        }
        let due = self.started.elapsed() >= RUNS_AT_LEAST;
        if due {
            self.left -= 1;
            self.started = Instant::now();
        }
        Some(due)
    }
}
