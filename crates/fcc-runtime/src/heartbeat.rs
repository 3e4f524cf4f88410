//! Whether the loop makes progress, for who watches from another thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicI32, AtomicU64, Ordering};

use fcc_timer::realtime;

const NOT_BEGUN: u64 = 0;
const OVER: u64 = u64::MAX;

/// The loop's heartbeat: one plain store a tick, which any thread may feel.
#[derive(Clone, Debug, Default)]
pub struct Heartbeat(Arc<Beats>);

#[derive(Debug)]
struct Beats {
    count: AtomicU64,
    /// The loop's thread, as the kernel numbers it; 0 before it began.
    thread: AtomicI32,
}

impl Default for Beats {
    fn default() -> Self {
        Self {
            count: AtomicU64::new(NOT_BEGUN),
            thread: AtomicI32::new(0),
        }
    }
}

/// What a heartbeat feels like.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HeartbeatReading {
    /// The loop has not begun.
    NotStarted,
    /// It runs; the number goes up with every tick.
    Beat(u64),
    /// The loop is over.
    Ended,
}

impl Heartbeat {
    /// How it feels now.
    pub fn read(&self) -> HeartbeatReading {
        match self.0.count.load(Ordering::Relaxed) {
            NOT_BEGUN => HeartbeatReading::NotStarted,
            OVER => HeartbeatReading::Ended,
            count => HeartbeatReading::Beat(count),
        }
    }

    /// The loop begins, on this thread.
    pub(crate) fn begin(&self) {
        self.0
            .thread
            .store(realtime::this_thread(), Ordering::Relaxed);
        self.0.count.store(NOT_BEGUN + 1, Ordering::Release);
    }

    /// A tick begins. Only the loop's thread writes, so this needs no
    /// read-modify-write.
    pub(crate) fn beat(&self) {
        let count = self.0.count.load(Ordering::Relaxed);
        if count != OVER {
            self.0.count.store(count + 1, Ordering::Relaxed);
        }
    }

    /// The loop is over.
    pub(crate) fn end(&self) {
        self.0.count.store(OVER, Ordering::Relaxed);
    }

    /// The loop's thread; 0 if it has not begun.
    pub(crate) fn thread(&self) -> i32 {
        self.0.thread.load(Ordering::Relaxed)
    }
}
