//! Locking the memory of the process.

use nix::errno::Errno;
use nix::sys::mman::{MlockAllFlags, mlockall, munlockall};
use nix::sys::resource::{Resource, getrlimit};
use std::fs;

use super::DeniedRequest;

/// The calling thread's own, because capabilities belong to threads.
const STATUS: &str = "/proc/thread-self/status";
/// How the users of this process' namespace map to those of the system.
const UID_MAP: &str = "/proc/self/uid_map";
/// The bit of `CAP_IPC_LOCK` in a set of capabilities.
const CAP_IPC_LOCK: u32 = 14;

/// Locks and loads what the process has mapped, and locks what it maps later,
/// once it is touched.
pub(super) fn lock() -> Result<(), DeniedRequest> {
    let denied = |reason: String| DeniedRequest {
        request: "locked memory".to_owned(),
        reason,
        remedy: "give the service LimitMEMLOCK=infinity (a shell: ulimit -l unlimited), \
                 or the program the right to: setcap cap_ipc_lock+ep"
            .to_owned(),
    };
    if let Some(limit_bytes) = limit() {
        return Err(denied(format!(
            "RLIMIT_MEMLOCK is {} KiB, where later allocations would fail",
            limit_bytes / 1024
        )));
    }
    // In two calls: pages mapped now are loaded, pages mapped later only when
    // they are touched.
    let later = MlockAllFlags::MCL_FUTURE | MlockAllFlags::from_bits_retain(libc::MCL_ONFAULT);
    mlockall(MlockAllFlags::MCL_CURRENT)
        .and_then(|()| mlockall(later))
        .map_err(|errno: Errno| {
            // Partly locked memory is useless. Unlocking needs no right and
            // cannot fail.
            let _ = munlockall();
            denied(format!("{errno:?}"))
        })?;
    if is_locked() {
        Ok(())
    } else {
        Err(denied(
            "the kernel reads back less locked than used memory".to_owned(),
        ))
    }
}

/// Whether at least as much memory is locked as is in use.
pub(super) fn is_locked() -> bool {
    fs::read_to_string(STATUS).is_ok_and(|status| {
        match (kib(&status, "VmLck:"), kib(&status, "VmRSS:")) {
            (Some(locked), Some(used)) => locked > 0 && locked >= used,
            _ => false,
        }
    })
}

/// How many bytes the calling thread may lock; `None` for any number.
#[cfg_attr(
    target_pointer_width = "64",
    expect(clippy::unnecessary_cast, reason = "32-bit systems count in 32 bits")
)]
fn limit() -> Option<u64> {
    let (soft, _) = getrlimit(Resource::RLIMIT_MEMLOCK).unwrap_or((0, 0));
    let exempt = || {
        fs::read_to_string(STATUS).is_ok_and(|status| has_capability(&status, CAP_IPC_LOCK))
            && fs::read_to_string(UID_MAP).is_ok_and(|map| is_whole_system(&map))
    };
    (soft != libc::RLIM_INFINITY && !exempt()).then_some(soft as u64)
}

fn kib(status: &str, field: &str) -> Option<u64> {
    value(status, field)?
        .strip_suffix("kB")?
        .trim()
        .parse()
        .ok()
}

fn has_capability(status: &str, bit: u32) -> bool {
    value(status, "CapEff:")
        .and_then(|set| u64::from_str_radix(set, 16).ok())
        .is_some_and(|set| set >> bit & 1 == 1)
}

fn value<'a>(status: &'a str, field: &str) -> Option<&'a str> {
    status
        .lines()
        .find_map(|line| line.strip_prefix(field))
        .map(str::trim)
}

/// A capability counts against the limit only in the first user namespace, the
/// one that maps every user to itself: in a container without root's rights
/// the set contains the capability, but the kernel denies the request.
fn is_whole_system(uid_map: &str) -> bool {
    uid_map.split_whitespace().eq(["0", "0", "4294967295"])
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDINARY: &str = "Name:\tfccd\nVmLck:\t       0 kB\nVmRSS:\t    5208 kB\n\
                            CapEff:\t0000000000000000\n";
    // What `capsh --decode` calls cap_ipc_lock.
    const WITH_IPC_LOCK: &str = "CapEff:\t0000000000004000\n";

    #[test]
    fn the_status_file_is_read_as_proc_5_writes_it() {
        assert_eq!(kib(ORDINARY, "VmLck:"), Some(0));
        assert_eq!(kib(ORDINARY, "VmRSS:"), Some(5208));
        assert_eq!(kib(ORDINARY, "VmSwap:"), None);
        assert_eq!(kib("VmRSS:\tmany kB", "VmRSS:"), None);
    }

    #[test]
    fn the_capability_is_one_bit() {
        assert!(!has_capability(ORDINARY, CAP_IPC_LOCK));
        assert!(has_capability(WITH_IPC_LOCK, CAP_IPC_LOCK));
        assert!(!has_capability("CapEff:\t0000000000800000\n", CAP_IPC_LOCK));
        assert!(!has_capability("", CAP_IPC_LOCK));
    }

    // As user_namespaces(7) shows the files.
    #[test]
    fn a_namespace_of_its_own_has_no_rights_over_the_system() {
        assert!(is_whole_system("         0          0 4294967295\n"));
        assert!(!is_whole_system("         0       1000          1\n"));
        assert!(!is_whole_system(""));
    }
}
