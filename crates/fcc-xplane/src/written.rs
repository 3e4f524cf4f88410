//! The values written to the yoke in the last seconds, to recognise them when they are read
//! back.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::round_trip::WrittenAgo;

/// Four and a half seconds at 128 Hz; at a higher rate less, which is still some frames.
const MOST: usize = 576;
/// A value is read back at most this long after it was written, over a slow network.
const READ_BACK_WITHIN: Duration = Duration::from_millis(4_500);
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

/// What a value that is read back is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ReadBack {
    /// The simulator shows something else than what is sent, as far as is known.
    Unknown,
    /// This program's, the same of which may have been written again since.
    Own(WrittenAgo),
    Foreign,
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
        if let Some(entry) = self.entries.get_mut(self.next) {
            let yoke = yoke.map(|value| value.unwrap_or(f32::NAN));
            *entry = Entry { yoke, at };
        }
        self.next = (self.next + 1) % MOST;
    }

    /// A value that was read back at `at`.
    pub(crate) fn recognise(&mut self, axis: usize, value: f32, at: Time) -> ReadBack {
        let is_same = |entry: &&Entry| {
            let written = entry.yoke.get(axis);
            written.is_some_and(|written| (written - value).abs() <= SAME)
        };
        let (later, earlier) = self.entries.split_at(self.next);
        let newest_first = later.iter().rev().chain(earlier.iter().rev());
        let mut same = newest_first
            .skip_while(|entry| !is_same(entry))
            .take_while(is_same)
            .map(|entry| at.since(entry.at));
        let age = same.next().filter(|age| *age <= READ_BACK_WITHIN);
        let age = age.map(|least| WrittenAgo {
            least,
            most: same.last().unwrap_or(least),
        });
        if self.recognised < RECOGNISED && value.abs() > SAME {
            self.recognised = if age.is_some() {
                self.recognised + 1
            } else {
                self.recognised.saturating_sub(1)
            };
        }
        match age {
            _ if self.recognised < RECOGNISED => ReadBack::Unknown,
            Some(age) => ReadBack::Own(age),
            None => ReadBack::Foreign,
        }
    }
}
