//! Panics of parts are caught, so that control is released.

use std::cell::{Cell, RefCell};
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    /// Whether this thread is inside [`caught`].
    static INSIDE: Cell<bool> = const { Cell::new(false) };
    /// Where the part panicked, set by the hook.
    static LOCATION: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Runs `part`; a panic in it is returned as its message, with its location if
/// known.
///
/// Unwind safety is asserted, not proven: after a panic the loop only releases
/// the actuators, each separately, and stops.
pub(crate) fn caught<T>(part: impl FnOnce() -> T) -> Result<T, String> {
    let outer = INSIDE.replace(true);
    let result = catch_unwind(AssertUnwindSafe(part));
    INSIDE.set(outer);
    result.map_err(|payload| {
        let message = payload
            .downcast_ref::<&'static str>()
            .copied()
            .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
            .unwrap_or("a panic without a message");
        match LOCATION.take() {
            Some(location) => format!("{message} (at {location})"),
            None => message.to_owned(),
        }
    })
}

/// From now on panics of a loop's parts are not printed in this process; other
/// panics are handled as before.
///
/// The default hook prints the panic, perhaps with a backtrace, *before* the
/// stack unwinds: on a suspended terminal or a full pipe it waits forever, and
/// the actuators are not released. The message is in the loop's report.
pub(crate) fn keep_quiet() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if INSIDE.get() {
                LOCATION.set(panic.location().map(ToString::to_string));
            } else {
                before(panic);
            }
        }));
    });
}
