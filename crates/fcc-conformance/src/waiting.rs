//! Whether a thread waits, as the kernel counts it.

use nix::sys::resource::{UsageWho, getrusage};

/// What `work` gives, and how often the calling thread gave up its CPU
/// meanwhile because it had to wait: for a datagram, a lock, a disk, a moment.
/// Being preempted does not count.
///
/// ```
/// use std::time::Duration;
///
/// let ((), waits) = fcc_conformance::waits(|| std::thread::sleep(Duration::from_millis(1)));
/// assert!(waits > 0);
/// ```
pub fn waits<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = voluntary_switches();
    let result = work();
    (result, voluntary_switches() - before)
}

fn voluntary_switches() -> u64 {
    let usage = getrusage(UsageWho::RUSAGE_THREAD);
    assert!(usage.is_ok(), "the kernel does not tell of threads");
    usage.map_or(0, |usage| usage.voluntary_context_switches() as u64)
}

/// A kernel that is short of memory, or another thread that maps some, makes
/// a thread wait now and then for nothing it did itself.
const TRIALS: usize = 5;

/// Asserts that `trial`, which says how often it waited, can be done without.
pub(crate) fn assert_never_waits(mut trial: impl FnMut() -> u64) {
    let mut least = u64::MAX;
    for _ in 0..TRIALS {
        least = least.min(trial());
        if least == 0 {
            return;
        }
    }
    assert_eq!(least, 0, "waits in each of {TRIALS} trials");
}
