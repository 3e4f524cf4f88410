//! Types in shared memory, and their names for other programs.

#![expect(unsafe_code, reason = "iceoryx2 asks for a promise about layouts")]

use iceoryx2::prelude::ZeroCopySend;

use super::{Event, Info, Status};
use fcc_telemetry::Telemetry;

/// The record of a tick in shared memory.
#[repr(transparent)]
pub(super) struct Published<C: Telemetry>(pub(super) C::Words);

impl<C: Telemetry> Clone for Published<C> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<C: Telemetry> Copy for Published<C> {}

impl<C: Telemetry> std::fmt::Debug for Published<C> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

// SAFETY: an array of numbers: `RecordWords` is implemented for nothing else.
unsafe impl<C: Telemetry> ZeroCopySend for Published<C> {
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
