//! How much the kernel may delay a wake-up.
//!
//! nix has no `prctl` for Android.
#![allow(unsafe_code)]

use nix::errno::Errno;

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
    // SAFETY: the call takes a number and no pointer.
    let answer = unsafe { libc::prctl(libc::PR_SET_TIMERSLACK, slack_ns as libc::c_ulong) };
    Errno::result(answer).map_err(|errno| denied(errno.to_string()))?;
    match get() {
        Some(granted_ns) if granted_ns <= slack_ns => Ok(()),
        Some(granted_ns) => Err(denied(format!("reads back as {granted_ns} ns"))),
        None => Err(denied("cannot be read back".to_owned())),
    }
}

/// The timer slack of the calling thread, ns.
pub(super) fn get() -> Option<u64> {
    // SAFETY: the call takes no argument.
    u64::try_from(unsafe { libc::prctl(libc::PR_GET_TIMERSLACK) }).ok()
}
