//! Types in shared memory: their names for other programs, and the check that
//! none has undefined bytes.

#![expect(unsafe_code, reason = "iceoryx2 asks for a promise about layouts")]

use iceoryx2::prelude::ZeroCopySend;

use super::command::{Answer, CommandRequest};
use super::{Event, Info, Status};

/// The size of a field.
const fn bytes_of<S, T>(_: fn(&S) -> &T) -> usize {
    size_of::<T>()
}

/// Declares a type in shared memory with all of its fields. It does not compile
/// if there is a byte between them or after them: such a byte would be
/// undefined, and another process reads it.
macro_rules! shared {
    ($type:ident as $name:literal: $($field:ident)+) => {
        const _: () = {
            let _every_field = |$type { $($field: _),+ }: &$type| ();
            assert!(
                size_of::<$type>() == 0 $(+ bytes_of(|of: &$type| &of.$field))+,
                "there are undefined bytes between the fields"
            );
        };

        // SAFETY: repr(C), numbers and bytes only, and nothing undefined between
        // them, which is checked above.
        unsafe impl ZeroCopySend for $type {
            unsafe fn type_name() -> &'static str {
                $name
            }
        }
    };
}

shared!(Info as "fcc.Info":
    layout record_bytes event_bytes status_bytes process_id priority memory_locked requests_denied
    started_unix_ns started_ns rate_hz software commit timer policy plant refusals);
shared!(Event as "fcc.v2.Event": tick time_ns code index values text);
shared!(Status as "fcc.v2.Status":
    time_ns ticks missed lateness_p50_ns lateness_p99_ns lateness_p99_9_ns lateness_max_ns
    lateness_counts not_published cpu_ns watchers recorder_state recorded not_recorded
    recording_bytes recording);
shared!(CommandRequest as "fcc.v5.Command": version code names values file sender);
shared!(Answer as "fcc.v5.CommandAnswer": code version tick value least most name text);
