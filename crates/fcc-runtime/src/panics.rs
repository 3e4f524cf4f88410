//! A panic in a part must not leave the controls held.

use std::cell::{Cell, RefCell};
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    /// Whether this thread is inside [`caught`].
    static INSIDE: Cell<bool> = const { Cell::new(false) };
    /// Where the part panicked, once there is a hook to tell.
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs `part`; a panic in it becomes its words, and its place if known.
///
/// Unwind safety is asserted, not proven: after a panic the loop only ever
/// releases the actuators and stops, and each of those is asked on its own.
pub(crate) fn caught<T>(part: impl FnOnce() -> T) -> Result<T, String> {
    let outer = INSIDE.replace(true);
    let result = catch_unwind(AssertUnwindSafe(part));
    INSIDE.set(outer);
    result.map_err(|payload| {
        let words = payload
            .downcast_ref::<&'static str>()
            .copied()
            .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
            .unwrap_or("a panic without words");
        match PLACE.take() {
            Some(place) => format!("{words} (at {place})"),
            None => words.to_owned(),
        }
    })
}

/// Keeps panics of a loop's parts off the error output, in this process, from
/// now on; those of everything else go where they went.
///
/// The usual hook prints the panic, perhaps with a backtrace, *before* the
/// stack unwinds: on a terminal that is held or a pipe that is full it waits
/// for ever, and the actuators with it. The words are in the loop's report.
pub(crate) fn keep_quiet() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if INSIDE.get() {
                PLACE.set(panic.location().map(ToString::to_string));
            } else {
                before(panic);
            }
        }));
    });
}
