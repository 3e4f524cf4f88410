//! CPU time and page faults of a thread.
//!
//! The difference of two readings is the cost of the work between them. None
//! of these functions allocates.
#![allow(unsafe_code)]

use std::mem::MaybeUninit;

use nix::sys::time::TimeValLike as _;
use nix::time::{ClockId, clock_gettime};

/// CPU time of the calling thread since it began, ns.
///
/// ```
/// let before = fcc_timer::usage::thread_cpu_ns();
/// let sum: u64 = std::hint::black_box((0..100_000).sum());
/// assert!(fcc_timer::usage::thread_cpu_ns() > before, "{sum} took no time");
/// ```
#[must_use]
pub fn thread_cpu_ns() -> i64 {
    read(ClockId::CLOCK_THREAD_CPUTIME_ID)
}

/// CPU time of all threads of the process since it began, ns.
#[must_use]
pub fn process_cpu_ns() -> i64 {
    read(ClockId::CLOCK_PROCESS_CPUTIME_ID)
}

fn read(clock: ClockId) -> i64 {
    // Linux always has these clocks, so the call cannot fail.
    clock_gettime(clock).map_or(0, |time| time.num_nanoseconds())
}

/// How often the kernel had to provide a page for a thread.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct PageFaults {
    /// The page was in memory already, or new: about 1 µs each.
    pub minor: u64,
    /// The page had to be read from a disk: milliseconds each.
    pub major: u64,
}

impl PageFaults {
    /// Both kinds together.
    #[must_use]
    pub const fn all(self) -> u64 {
        self.minor.saturating_add(self.major)
    }
}

/// Page faults of the calling thread since it began. A loop that runs in
/// locked memory has none.
#[must_use]
pub fn page_faults() -> PageFaults {
    // RUSAGE_THREAD (getrusage(2)), which neither libc nor nix has for Android.
    let this_thread = 1;
    let mut usage = MaybeUninit::<libc::rusage>::zeroed();
    // SAFETY: the kernel writes one rusage through the pointer, during the call.
    // The call can fail for a bad argument only; then the zeros stay, which are
    // a valid value of plain numbers.
    let usage = unsafe {
        libc::getrusage(this_thread, usage.as_mut_ptr());
        usage.assume_init()
    };
    PageFaults {
        minor: usage.ru_minflt as u64,
        major: usage.ru_majflt as u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;
    use std::time::Duration;

    #[test]
    fn a_sleeping_thread_uses_no_cpu_time_of_its_own() {
        let (before, clock_before) = (thread_cpu_ns(), crate::deadlines::monotonic_ns());
        thread::sleep(Duration::from_millis(50));
        let slept_ns = crate::deadlines::monotonic_ns() - clock_before;
        assert!(slept_ns >= 50_000_000);
        assert!(thread_cpu_ns() - before < slept_ns / 2);
    }

    #[test]
    fn the_process_counts_what_another_thread_uses() {
        let used_ns = thread::spawn(|| {
            while thread_cpu_ns() < 2_000_000 {
                std::hint::spin_loop();
            }
            thread_cpu_ns()
        })
        .join()
        .unwrap();
        assert!(process_cpu_ns() >= used_ns);
    }

    #[test]
    fn touching_new_pages_faults() {
        const PAGES: u64 = 64;
        let before = page_faults();
        let mut fresh = vec![0_u8; 2 * PAGES as usize * 4096];
        for byte in fresh.iter_mut().step_by(4096) {
            *byte = 1;
        }
        std::hint::black_box(&fresh);
        // Fewer than one per page: the kernel may hand out larger ones.
        assert!(page_faults().minor > before.minor);
    }
}
