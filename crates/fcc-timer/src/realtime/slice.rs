//! For how long the ordinary scheduler lets a thread run at a time.
//!
//! Since Linux 6.12 a thread of `SCHED_OTHER` may ask for a slice of its own in
//! `sched_runtime` (`sched_setattr(2)`; Documentation/scheduler/sched-eevdf.rst). A
//! shorter one brings the thread's deadline nearer, and with it its turn when it wakes
//! beside threads that compute: without it, it waits for the end of theirs, some 3 ms.
//! Older kernels ignore the request, so they are not asked: Androids of their time may end
//! a program for a system call that is not on their list.
#![allow(unsafe_code)]

use nix::errno::Errno;
use nix::sys::utsname::uname;

/// The first kernel, major and minor, that knows a thread's own slice.
const SINCE: (u32, u32) = (6, 12);

/// The kernel's smallest slice, ns.
const SHORTEST_NS: u64 = 100_000;
/// The thread id that means the calling thread.
const THIS_THREAD: libc::pid_t = 0;
const NO_FLAGS: libc::c_uint = 0;

/// What the kernel calls `sched_attr`, as of Linux 3.14; libc has none for Android.
#[repr(C)]
#[derive(Clone, Copy, Default)]
struct Attributes {
    size: u32,
    policy: u32,
    flags: u64,
    nice: i32,
    priority: u32,
    runtime_ns: u64,
    deadline_ns: u64,
    period_ns: u64,
}

/// Asks for the shortest slice for the calling thread, and leaves its policy and nice
/// value as they are.
pub(super) fn shorten() {
    let Ok(present) = read() else { return };
    let wanted = Attributes {
        runtime_ns: SHORTEST_NS,
        ..present
    };
    // SAFETY: the kernel reads as many bytes through the pointer as `size` says, during
    // the call.
    let _ = unsafe {
        libc::syscall(
            libc::SYS_sched_setattr,
            THIS_THREAD,
            &raw const wanted,
            NO_FLAGS,
        )
    };
}

/// The slice of the calling thread, ns; where the kernel does not say it, none.
pub(super) fn get() -> Option<u64> {
    read()
        .ok()
        .map(|present| present.runtime_ns)
        .filter(|slice_ns| *slice_ns > 0)
}

/// Whether a kernel of this release knows slices: `6.12.1-android16-5`.
fn is_known_to(release: &str) -> bool {
    let mut numbers = release.split(|character: char| !character.is_ascii_digit());
    let mut next = || numbers.next()?.parse().ok();
    matches!((next(), next()), (Some(major), Some(minor)) if (major, minor) >= SINCE)
}

fn read() -> Result<Attributes, Errno> {
    let release = uname()?;
    if !release.release().to_str().is_some_and(is_known_to) {
        return Err(Errno::ENOSYS);
    }
    let mut present = Attributes::default();
    // SAFETY: the kernel writes at most the stated size through the pointer, during the
    // call, and every pattern of bits is a value of these fields.
    let answer = unsafe {
        libc::syscall(
            libc::SYS_sched_getattr,
            THIS_THREAD,
            &raw mut present,
            size_of::<Attributes>() as libc::c_uint,
            NO_FLAGS,
        )
    };
    Errno::result(answer).map(|_| present)
}

#[cfg(test)]
mod tests {
    use super::is_known_to;

    /// Releases as phones, Debian and a Pi print them.
    #[test]
    fn kernels_before_6_12_are_not_asked() {
        for known in ["6.12.23-android16-5", "6.12.0", "6.18.44-fc", "7.0-rc1"] {
            assert!(is_known_to(known), "{known}");
        }
        for unknown in [
            "4.14.190-perf",
            "5.10.43-android12-9",
            "6.6.30+rpt-rpi-v8",
            "6",
            "",
        ] {
            assert!(!is_known_to(unknown), "{unknown}");
        }
    }
}
