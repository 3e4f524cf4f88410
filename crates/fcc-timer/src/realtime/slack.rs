//! How much the kernel may delay a wake-up.

use nix::sys::prctl;

use super::DeniedRequest;

/// Sets the timer slack of the calling thread, ns.
pub(super) fn set(slack_ns: u64) -> Result<(), DeniedRequest> {
    let denied = |reason: String| DeniedRequest {
        request: format!("timer slack of {slack_ns} ns"),
        reason,
        remedy: "choose 1 ns or more, and no more than a second".to_owned(),
    };
    // 0 selects the kernel's default of 50 µs.
    if slack_ns == 0 {
        return Err(denied("0 means the kernel's default".to_owned()));
    }
    prctl::set_timerslack(slack_ns as libc::c_ulong)
        .map_err(|errno| denied(format!("{errno:?}")))?;
    match get() {
        Some(granted_ns) if granted_ns <= slack_ns => Ok(()),
        granted => Err(denied(format!("reads back as {granted:?}"))),
    }
}

/// The timer slack of the calling thread, ns.
pub(super) fn get() -> Option<u64> {
    prctl::get_timerslack()
        .ok()
        .and_then(|slack_ns| u64::try_from(slack_ns).ok())
}
