//! Whether the loop makes progress, readable from another thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicI32, AtomicU64, Ordering};

use fcc_timer::realtime;

const NOT_STARTED: u64 = 0;
const ENDED: u64 = u64::MAX;

/// The loop's heartbeat: one atomic store a tick, which any thread may read.
#[derive(Clone, Debug, Default)]
pub struct Heartbeat(Arc<Beats>);

#[derive(Debug)]
struct Beats {
    count: AtomicU64,
    /// The kernel's number of the loop's thread; 0 before it starts.
    thread: AtomicI32,
}

impl Default for Beats {
    fn default() -> Self {
        Self {
            count: AtomicU64::new(NOT_STARTED),
            thread: AtomicI32::new(0),
        }
    }
}

/// A reading of the heartbeat.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HeartbeatReading {
    /// The loop has not started.
    NotStarted,
    /// The loop runs; the number increases with every tick.
    Beat(u64),
    /// The loop has ended.
    Ended,
}

impl Heartbeat {
    /// The present reading.
    pub fn read(&self) -> HeartbeatReading {
        match self.0.count.load(Ordering::Relaxed) {
            NOT_STARTED => HeartbeatReading::NotStarted,
            ENDED => HeartbeatReading::Ended,
            count => HeartbeatReading::Beat(count),
        }
    }

    /// The loop starts, on this thread.
    pub(crate) fn begin(&self) {
        self.0
            .thread
            .store(realtime::this_thread(), Ordering::Relaxed);
        self.0.count.store(NOT_STARTED + 1, Ordering::Release);
    }

    /// A tick starts. Only the loop's thread writes, so this needs no
    /// read-modify-write.
    pub(crate) fn beat(&self) {
        let count = self.0.count.load(Ordering::Relaxed);
        if count != ENDED {
            self.0.count.store(count + 1, Ordering::Relaxed);
        }
    }

    /// The loop has ended.
    pub(crate) fn end(&self) {
        self.0.count.store(ENDED, Ordering::Relaxed);
    }

    /// The loop's thread; 0 if it has not started.
    pub(crate) fn thread(&self) -> i32 {
        self.0.thread.load(Ordering::Relaxed)
    }
}
