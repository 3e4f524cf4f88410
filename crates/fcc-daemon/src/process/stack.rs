//! The stack of the first thread, which grows up to a limit of the process: beyond it
//! the kernel ends the program, in flight as well.

use nix::sys::resource::{Resource, getrlimit, rlim_t, setrlimit};

/// Enough for every command, and a usual limit. A flight needs some 0.5 MiB to begin.
const WANTED_BYTES: rlim_t = 8 << 20;
/// Less than this is refused.
const LEAST_BYTES: rlim_t = 2 << 20;

/// Raises the limit on the stack (`RLIMIT_STACK`) to what is wanted, as far as it may be
/// raised.
///
/// # Errors
/// When it may not be raised far enough, with what to do.
pub(crate) fn raise_stack_limit() -> Result<(), String> {
    let Ok((soft, hard)) = getrlimit(Resource::RLIMIT_STACK) else {
        return Ok(());
    };
    if soft >= WANTED_BYTES {
        return Ok(());
    }
    // Root may raise both. The stack of the first thread grows up to the limit of the
    // moment, so that this helps a program that runs already.
    let raised = [
        (WANTED_BYTES, hard.max(WANTED_BYTES)),
        (hard.min(WANTED_BYTES), hard),
    ]
    .into_iter()
    .find(|&(soft, hard)| setrlimit(Resource::RLIMIT_STACK, soft, hard).is_ok())
    .map_or(soft, |(soft, _)| soft);
    if raised >= LEAST_BYTES {
        return Ok(());
    }
    Err(format!(
        "the limit on the stack is {} KiB, and a flight needs {}: raise it with `ulimit -s {}`, \
         or LimitSTACK= of a systemd service",
        raised >> 10,
        LEAST_BYTES >> 10,
        WANTED_BYTES >> 10
    ))
}
