//! What was last written to the yoke, to recognise a write that arrives after
//! the release.

use core::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

/// Thirty seconds at 40 Hz; at a higher rate less.
const MOST: usize = 1_200;
/// X-Plane stores a written ratio as f32, as it was sent: the difference is a
/// rounding error.
const SAME: f32 = 1e-6;

/// The last values written to elevator, aileron and rudder, as bits; 0 for none:
/// a release writes 0 as well.
#[derive(Debug)]
pub(crate) struct SentYoke {
    values: [[AtomicU32; 3]; MOST],
    next: AtomicUsize,
}

impl SentYoke {
    pub(crate) const fn new() -> Self {
        Self {
            values: [const { [const { AtomicU32::new(0) }; 3] }; MOST],
            next: AtomicUsize::new(0),
        }
    }

    pub(crate) fn add(&self, yoke: [Option<f32>; 3]) {
        let next = self.next.fetch_add(1, Ordering::Relaxed) % MOST;
        for (slot, value) in self.values.get(next).into_iter().flatten().zip(yoke) {
            slot.store(value.unwrap_or(0.0).to_bits(), Ordering::Relaxed);
        }
    }

    /// Whether nothing was written.
    pub(crate) fn is_empty(&self) -> bool {
        self.next.load(Ordering::Relaxed) == 0
    }

    /// Whether this value was written to an axis: 0 elevator, 1 aileron, 2
    /// rudder.
    pub(crate) fn holds(&self, axis: usize, value: f32) -> bool {
        value.abs() <= SAME
            || self
                .values
                .iter()
                .filter_map(|yoke| yoke.get(axis))
                .any(|sent| (f32::from_bits(sent.load(Ordering::Relaxed)) - value).abs() <= SAME)
    }
}
