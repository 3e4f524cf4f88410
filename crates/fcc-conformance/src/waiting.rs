//! Whether a thread waits, as counted by the kernel.

use nix::sys::resource::{UsageWho, getrusage};

/// The result of `work`, and how often the calling thread gave up its CPU
/// meanwhile because it had to wait: for a datagram, a lock, a disk, a time.
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
    assert!(usage.is_ok(), "the kernel has no usage of threads");
    usage.map_or(0, |usage| usage.voluntary_context_switches() as u64)
}

/// If memory is short, or another thread maps memory, the kernel occasionally
/// makes a thread wait without its own action.
const TRIALS: usize = 5;

/// Asserts that `trial`, which returns how often it waited, can return 0.
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
