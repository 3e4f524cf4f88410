//! What lies in shared memory, and what other programs know it by.

#![expect(unsafe_code, reason = "iceoryx2 asks for a promise about layouts")]

use iceoryx2::prelude::ZeroCopySend;

use super::{Event, Info, Status};
use fcc_telemetry::FlightWords;

/// The record of a tick in shared memory.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub(super) struct Published(pub(super) FlightWords);

// SAFETY: an array of numbers.
unsafe impl ZeroCopySend for Published {
    unsafe fn type_name() -> &'static str {
        "fcc.v2.Record"
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
        "fcc.v2.Event"
    }
}

// SAFETY: repr(C), numbers and bytes only.
unsafe impl ZeroCopySend for Status {
    unsafe fn type_name() -> &'static str {
        "fcc.v2.Status"
    }
}
