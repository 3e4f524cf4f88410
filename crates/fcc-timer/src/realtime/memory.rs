//! Locking the memory of the process.
#![allow(unsafe_code)]

use nix::errno::Errno;
use nix::sys::mman::{MlockAllFlags, mlock, mlockall, munlockall};
use nix::sys::resource::{Resource, getrlimit};
use std::fs;
use std::ops::Range;
use std::ptr::{self, NonNull};

use super::DeniedRequest;

/// The calling thread's own, because capabilities belong to threads.
const STATUS: &str = "/proc/thread-self/status";
/// What the process has mapped.
const MAPS: &str = "/proc/self/maps";
/// How the users of this process' namespace map to those of the system.
const UID_MAP: &str = "/proc/self/uid_map";
/// The bit of `CAP_IPC_LOCK` in a set of capabilities.
const CAP_IPC_LOCK: u32 = 14;

/// Locks and loads what the process has mapped, and locks what it maps later,
/// once it is touched. `on_touch`, the calling thread's stack, is also loaded
/// only where it is touched: few threads use a part of theirs that matters.
pub(super) fn lock(on_touch: &Range<usize>) -> Result<(), DeniedRequest> {
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
    // Everything when it is touched, and then what is mapped now at once.
    let on_fault = MlockAllFlags::from_bits_retain(libc::MCL_ONFAULT);
    mlockall(MlockAllFlags::MCL_CURRENT | MlockAllFlags::MCL_FUTURE | on_fault)
        .and_then(|()| load(on_touch))
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

/// Loads what is mapped now and may be accessed, but for one range.
fn load(except: &Range<usize>) -> Result<(), Errno> {
    let maps = fs::read_to_string(MAPS).map_err(|_| Errno::EIO)?;
    for Range { start, end } in maps.lines().filter_map(mapping) {
        for part in [start..end.min(except.start), start.max(except.end)..end] {
            let length = part.end.saturating_sub(part.start);
            let Some(first) = NonNull::new(ptr::without_provenance_mut(part.start)) else {
                continue;
            };
            if length > 0 {
                // Another thread may have unmapped it, and there may be no page,
                // as beyond a file's end: such pages are locked when touched.
                // SAFETY: nothing is read or written through the pointer; the
                // kernel refuses a range that is not mapped.
                let _ = unsafe { mlock(first, length) };
            }
        }
    }
    Ok(())
}

/// The addresses of a line of the table of mappings; none if nothing there can
/// be loaded: a guard page, or a page of the kernel's.
fn mapping(line: &str) -> Option<Range<usize>> {
    let mut words = line.split_whitespace();
    let (first, end) = words.next()?.split_once('-')?;
    let is_accessible = words.next()?.starts_with('r');
    let is_kernels = words.nth(3).is_some_and(|name| name.starts_with("[v"));
    let address = |digits| usize::from_str_radix(digits, 16).ok();
    let range = address(first)?..address(end)?;
    (is_accessible && !is_kernels).then_some(range)
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
#[allow(
    clippy::cast_lossless,
    reason = "a limit has 32 bits on 32-bit Android"
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

    // As proc_pid_maps(5) shows the lines.
    #[test]
    fn guard_pages_and_the_kernels_pages_are_not_loaded() {
        let of = |rest: &str| mapping(&format!("7f0000001000-7f0000003000 {rest}"));
        let range = Some(0x7f00_0000_1000..0x7f00_0000_3000);
        assert_eq!(
            of("r-xp 00000000 08:02 173521      /usr/bin/dbus-daemon"),
            range
        );
        assert_eq!(of("rw-p 00000000 00:00 0"), range);
        assert_eq!(of("---p 00000000 00:00 0"), None);
        assert_eq!(of("r-xp 00000000 00:00 0           [vdso]"), None);
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
