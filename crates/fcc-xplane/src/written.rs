//! The values written to the yoke in the last one and a half seconds, to recognise them when
//! they are read back.

use core::time::Duration;

use fcc_core::framework::Time;

/// One and a half seconds at 128 Hz; at a higher rate less, which is still some
/// frames.
const MOST: usize = 192;
/// A value is read back at most this long after it was written.
const READ_BACK_WITHIN: Duration = Duration::from_secs(1);
/// X-Plane stores what was written as f32, as it was sent.
const SAME: f32 = 1e-4;

/// From so many on, all values are expected to be recognised.
const RECOGNISED: u8 = 40;

/// Elevator, aileron and rudder, and when they were written; NaN for none.
#[derive(Clone, Copy, Debug)]
struct Entry {
    yoke: [f32; 3],
    at: Time,
}

/// The last values written.
#[derive(Clone, Debug)]
pub(crate) struct Written {
    entries: [Entry; MOST],
    next: usize,
    /// The values other than 0 that were recognised, less those that were not,
    /// up to [`RECOGNISED`]: a simulator that stores something else than what
    /// is sent shows few, by chance.
    recognised: u8,
}

impl Written {
    pub(crate) const fn new() -> Self {
        let never = Entry {
            yoke: [f32::NAN; 3],
            at: Time::NEVER,
        };
        Self {
            entries: [never; MOST],
            next: 0,
            recognised: 0,
        }
    }

    pub(crate) fn add(&mut self, at: Time, yoke: [Option<f32>; 3]) {
        if let Some(entry) = self.entries.get_mut(self.next % MOST) {
            let yoke = yoke.map(|value| value.unwrap_or(f32::NAN));
            *entry = Entry { yoke, at };
        }
        self.next = (self.next + 1) % MOST;
    }

    /// Whether a value read back at `at` was not written, by a simulator that
    /// shows what is written.
    pub(crate) fn is_foreign(&mut self, axis: usize, value: f32, at: Time) -> bool {
        let ours = self.entries.iter().any(|entry| {
            at.since(entry.at) <= READ_BACK_WITHIN
                && entry
                    .yoke
                    .get(axis)
                    .is_some_and(|written| (written - value).abs() <= SAME)
        });
        if self.recognised < RECOGNISED && value.abs() > SAME {
            self.recognised = if ours {
                self.recognised + 1
            } else {
                self.recognised.saturating_sub(1)
            };
        }
        self.recognised == RECOGNISED && !ours
    }
}
