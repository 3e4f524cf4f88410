//! A record as it lies in shared memory.

#![expect(
    unsafe_code,
    reason = "iceoryx2 asks for a promise about layouts, and a record is taken as it lies there"
)]

use std::mem::{offset_of, size_of};

use fcc_core::flight::{Measurements, Plant, PlantState};
use fcc_core::framework::{Reading, Switch};
use iceoryx2::prelude::ZeroCopySend;

use super::{Event, Info, Status};
use crate::FlightRecord;

/// The record of a tick, as the daemon puts it into shared memory.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub(super) struct Published(pub(super) FlightRecord);

/// The same bytes as a watcher finds them: what another process wrote may be
/// anything, and in Rust not every byte is a `bool`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Found([u64; WORDS]);

const WORDS: usize = size_of::<FlightRecord>() / size_of::<u64>();

const _: () = assert!(
    size_of::<Found>() == size_of::<FlightRecord>()
        && align_of::<Found>() == align_of::<FlightRecord>(),
    "a record is a whole number of words"
);

/// What other programs know the types by; the version is the layout's.
const RECORD: &str = "fcc.v1.Record";

// SAFETY: plain repr(C) numbers all the way down, no pointer, no handle.
unsafe impl ZeroCopySend for Published {
    unsafe fn type_name() -> &'static str {
        RECORD
    }
}

// SAFETY: an array of numbers, of the size and alignment of `Published`.
unsafe impl ZeroCopySend for Found {
    unsafe fn type_name() -> &'static str {
        RECORD
    }
}

// SAFETY: repr(C), numbers and bytes only.
unsafe impl ZeroCopySend for Info {
    unsafe fn type_name() -> &'static str {
        "fcc.Info"
    }
}

// SAFETY: repr(C), numbers and bytes only.
unsafe impl ZeroCopySend for Event {
    unsafe fn type_name() -> &'static str {
        "fcc.v1.Event"
    }
}

// SAFETY: repr(C), numbers and bytes only.
unsafe impl ZeroCopySend for Status {
    unsafe fn type_name() -> &'static str {
        "fcc.v1.Status"
    }
}

/// Where the engage switch lies.
const SWITCH: usize = offset_of!(FlightRecord, measurements)
    + offset_of!(Measurements, engage_switch)
    + offset_of!(Reading<Switch>, value);
/// Where the state of a simulated plant lies.
const PLANT_STATE: usize = offset_of!(FlightRecord, measurements)
    + offset_of!(Measurements, plant)
    + offset_of!(Reading<Plant>, value)
    + offset_of!(Plant, state);
/// Where it lies whether outputs were sent.
const SENT: usize = offset_of!(FlightRecord, sent);

/// The bytes that may not be just anything, and the largest that each may be:
/// `Switch`, `PlantState` and `bool` count from 0 without a gap.
const CHECKED: [(usize, u8); 3] = [
    (SWITCH, Switch::On as u8),
    (PLANT_STATE, PlantState::Jumped as u8),
    (SENT, 1),
];

impl Found {
    /// The record; none if it is none.
    pub(super) fn record(&self) -> Option<FlightRecord> {
        let good = CHECKED
            .iter()
            .all(|(at, most)| self.byte(*at).is_some_and(|byte| byte <= *most));
        // SAFETY: size and alignment are those of a record, and every part of it
        // takes any bits but the three just checked.
        good.then(|| unsafe { std::ptr::from_ref(self).cast::<FlightRecord>().read() })
    }

    fn byte(&self, at: usize) -> Option<u8> {
        let word = self.0.get(at / size_of::<u64>())?.to_ne_bytes();
        word.get(at % size_of::<u64>()).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(record: &FlightRecord) -> Found {
        // A record has holes, whose bytes are not defined; these are zero.
        let mut found = Found([0; WORDS]);
        // SAFETY: sizes and alignments are the same.
        unsafe {
            std::ptr::from_mut(&mut found)
                .cast::<FlightRecord>()
                .write(*record);
        }
        found
    }

    #[test]
    fn a_record_comes_back() {
        let mut record = FlightRecord::default();
        record.tick.number = 7;
        record.measurements.heading_rad =
            Reading::new(1.5, fcc_core::framework::Time::from_nanos(3));
        record.measurements.engage_switch.value = Switch::On;
        record.measurements.plant.value.state = PlantState::Jumped;
        record.sent = true;
        assert_eq!(found(&record).record(), Some(record));
    }

    #[test]
    fn what_is_no_record_is_not_taken_for_one() {
        for (at, most) in CHECKED {
            let mut found = found(&FlightRecord::default());
            let mut bytes = found.0[at / 8].to_ne_bytes();
            bytes[at % 8] = most + 1;
            found.0[at / 8] = u64::from_ne_bytes(bytes);
            assert_eq!(found.record(), None, "byte {at}");
        }
    }
}
