//! The state of a serial line.

use core::sync::atomic::{AtomicI32, AtomicU64, Ordering};
use std::sync::Arc;

use fcc_xplane::Errno;

/// What the loop and the thread that serves the line share.
#[derive(Debug, Default)]
pub(crate) struct Line {
    /// Why there is no line now; 0 if there is one.
    pub(crate) errno: AtomicI32,
    pub(crate) sent: AtomicU64,
    pub(crate) written: AtomicU64,
    pub(crate) dropped: AtomicU64,
    pub(crate) received: AtomicU64,
    pub(crate) corrupt: AtomicU64,
    pub(crate) lost: AtomicU64,
    pub(crate) floods: AtomicU64,
}

impl Line {
    pub(crate) fn lost(&self) -> Result<(), Errno> {
        match self.errno.load(Ordering::Relaxed) {
            0 => Ok(()),
            errno => Err(errno),
        }
    }
}

/// The state of a serial line, readable from any thread without a lock.
#[derive(Clone, Debug, Default)]
pub struct LineStatus(pub(crate) Arc<Line>);

impl LineStatus {
    /// Whether the line is open.
    pub fn is_open(&self) -> bool {
        self.0.errno.load(Ordering::Relaxed) == 0
    }

    /// Messages given to the line.
    pub fn sent(&self) -> u64 {
        self.0.sent.load(Ordering::Acquire)
    }

    /// Of these, the ones that the operating system took.
    pub fn written(&self) -> u64 {
        self.0.written.load(Ordering::Acquire)
    }

    /// The ones that were dropped: the line was lost before they were written.
    pub fn dropped(&self) -> u64 {
        self.0.dropped.load(Ordering::Acquire)
    }

    /// Frames that arrived with the right checksum.
    pub fn received(&self) -> u64 {
        self.0.received.load(Ordering::Acquire)
    }

    /// What arrived between two delimiters and was no frame.
    pub fn corrupt(&self) -> u64 {
        self.0.corrupt.load(Ordering::Acquire)
    }

    /// How often more arrived within 100 ms than any board sends, 100,000 bytes, and the
    /// rest was dropped.
    pub fn floods(&self) -> u64 {
        self.0.floods.load(Ordering::Acquire)
    }

    /// Frames that did not arrive, by their numbers.
    pub fn lost(&self) -> u64 {
        self.0.lost.load(Ordering::Acquire)
    }
}
