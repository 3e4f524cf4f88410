//! The signals that end a flight: TERM, INT and, unless it was started to
//! ignore that one, HUP.

use std::fs;
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use fcc_runtime::StopHandle;
use nix::sys::signal::{SigSet, Signal};

const ENDING: [Signal; 3] = [Signal::SIGTERM, Signal::SIGINT, Signal::SIGHUP];

/// The signals set the loop's stop flag, which is all that a signal may safely
/// do; the loop releases the controls in its next tick. A second flag, returned,
/// tells afterwards that it was a signal.
pub(super) fn stop_by(stop: &StopHandle) -> io::Result<Arc<AtomicBool>> {
    let interrupted = Arc::new(AtomicBool::new(false));
    for signal in ENDING.into_iter().filter(|signal| !is_ignored(*signal)) {
        for flag in [stop.flag(), Arc::clone(&interrupted)] {
            signal_hook::flag::register(signal as i32, flag)?;
        }
    }
    // A limit on the size of files must end the recording, not the flight: with
    // this caught, the write that goes too far is an error like any other.
    signal_hook::flag::register(Signal::SIGXFSZ as i32, Arc::default())?;
    Ok(interrupted)
}

/// Whether this program was started to fly on when its terminal hangs up, as
/// nohup(1) does.
fn is_ignored(signal: Signal) -> bool {
    // A mask in hexadecimal digits, proc(5).
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

/// While this lives the signals wait, and a thread that starts leaves them to
/// this one for good: the kernel hands a process' signal to any thread that
/// takes it, and the loop's has better to do.
pub(super) struct Kept(SigSet);

impl Kept {
    pub(super) fn from_new_threads() -> io::Result<Self> {
        let signals = SigSet::from_iter(ENDING);
        signals.thread_block()?;
        Ok(Self(signals))
    }
}

impl Drop for Kept {
    fn drop(&mut self) {
        // Cannot fail with a set that was just blocked.
        let _ = self.0.thread_unblock();
    }
}
