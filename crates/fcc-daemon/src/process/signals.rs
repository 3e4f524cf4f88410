//! The signals that end a flight: TERM, INT and, unless it is ignored from the
//! start, HUP.

use std::fs;
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use fcc_runtime::StopHandle;
use nix::sys::signal::{SigSet, Signal};

const ENDING: [Signal; 3] = [Signal::SIGTERM, Signal::SIGINT, Signal::SIGHUP];

/// The signals set the loop's stop flag, which is safe in a signal handler; the
/// loop releases the controls in its next tick. The returned flag shows
/// afterwards that it was a signal.
pub(super) fn stop_by(stop: &StopHandle) -> io::Result<Arc<AtomicBool>> {
    let interrupted = Arc::new(AtomicBool::new(false));
    for signal in ENDING.into_iter().filter(|signal| !is_ignored(*signal)) {
        for flag in [stop.flag(), Arc::clone(&interrupted)] {
            signal_hook::flag::register(signal as i32, flag)?;
        }
    }
    // A limit on file sizes must end the recording, not the flight: with this
    // handler, the write beyond the limit fails with an error.
    signal_hook::flag::register(Signal::SIGXFSZ as i32, Arc::default())?;
    Ok(interrupted)
}

/// Whether this program was started to ignore a hang-up of its terminal, as by
/// nohup(1).
fn is_ignored(signal: Signal) -> bool {
    // A hexadecimal mask, see proc(5).
    let ignored = fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|status| {
            let line = status
                .lines()
                .find_map(|line| line.strip_prefix("SigIgn:"))?;
            u64::from_str_radix(line.trim(), 16).ok()
        });
    signal == Signal::SIGHUP && ignored.is_some_and(|mask| mask >> (signal as u32 - 1) & 1 == 1)
}

/// Blocks the signals in threads started while this lives. The kernel delivers
/// a signal to any thread that does not block it, and it must not be the
/// loop's.
pub(super) struct BlockedSignals(SigSet);

impl BlockedSignals {
    pub(super) fn in_new_threads() -> io::Result<Self> {
        let signals = SigSet::from_iter(ENDING);
        signals.thread_block()?;
        Ok(Self(signals))
    }
}

impl Drop for BlockedSignals {
    fn drop(&mut self) {
        // Cannot fail for a set that was blocked before.
        let _ = self.0.thread_unblock();
    }
}
