//! Types in shared memory, and their names for other programs.

#![expect(unsafe_code, reason = "iceoryx2 asks for a promise about layouts")]

use iceoryx2::prelude::ZeroCopySend;

use super::{Event, Info, Status};

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
