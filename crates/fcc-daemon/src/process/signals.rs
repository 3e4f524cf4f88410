//! The signals that end a flight: TERM, INT, QUIT and, unless it is ignored from
//! the start, HUP; and those that must not stop or end it.

use std::fs;
use std::io;
use std::os::unix::process::parent_id;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use fcc_runtime::StopHandle;
use nix::sys::prctl;
use nix::sys::signal::{SigSet, Signal};

const ENDING: [Signal; 4] = [
    Signal::SIGTERM,
    Signal::SIGINT,
    Signal::SIGQUIT,
    Signal::SIGHUP,
];

/// What has no meaning for a flight: what a terminal sends to a process in the
/// background that reads or writes it, and what would end a process without a
/// release by default (signal(7)).
const WITHOUT_EFFECT: [Signal; 5] = [
    Signal::SIGTTIN,
    Signal::SIGTTOU,
    Signal::SIGUSR1,
    Signal::SIGUSR2,
    Signal::SIGALRM,
];

/// From here on a write beyond a limit on file sizes (`RLIMIT_FSIZE`) fails with
/// an error, instead of ending the process: it must end the recording or the
/// telemetry, not the flight.
pub(crate) fn survive_file_size_limit() -> io::Result<()> {
    signal_hook::flag::register(Signal::SIGXFSZ as i32, Arc::default())?;
    Ok(())
}

/// Prepares for a flight, before any thread is started: a process that is
/// stopped holds the controls.
pub(crate) fn tolerate() -> io::Result<()> {
    // Blocked, in the threads started from here on too: the terminal then
    // accepts what is written. A handler would be called again and again.
    SigSet::from_iter(WITHOUT_EFFECT).thread_block()?;
    Ok(())
}

/// From here on this process gets SIGTERM when `parent`, which started it,
/// ends for any reason (`PR_SET_PDEATHSIG`, prctl(2)).
///
/// # Errors
/// When `parent` has ended already, or is not what started this process.
pub(crate) fn end_with_parent(parent: u32) -> io::Result<()> {
    prctl::set_pdeathsig(Signal::SIGTERM)?;
    // An end before that call sends nothing.
    if parent_id() == parent {
        Ok(())
    } else {
        Err(io::Error::other(
            "it has ended, or has not started this one",
        ))
    }
}

/// What the signals have done.
#[derive(Default)]
pub(super) struct Caught {
    /// The number of the signal that ended the flight, 0 for none.
    ended_by: Arc<AtomicUsize>,
    /// Ctrl-Z was pressed, and had no effect.
    pub(super) suspended: Arc<AtomicBool>,
}

impl Caught {
    /// The signal that ended the flight, as text for users.
    pub(super) fn interrupted_by(&self) -> Option<&'static str> {
        let number = self.ended_by.load(Ordering::Relaxed);
        ENDING
            .into_iter()
            .find(|signal| *signal as usize == number)
            .map(|signal| match signal {
                Signal::SIGINT => "Ctrl-C (SIGINT)",
                Signal::SIGQUIT => "Ctrl-\\ (SIGQUIT)",
                Signal::SIGHUP => "the end of its terminal (SIGHUP)",
                other => other.as_str(),
            })
    }
}

/// The signals set the loop's stop flag, which is safe in a signal handler; the
/// loop releases the controls in its next tick.
pub(super) fn stop_by(stop: &StopHandle) -> io::Result<Caught> {
    let caught = Caught::default();
    signal_hook::flag::register(Signal::SIGTSTP as i32, Arc::clone(&caught.suspended))?;
    for signal in ENDING.into_iter().filter(|signal| !is_ignored(*signal)) {
        let (signal, number) = (signal as i32, signal as usize);
        signal_hook::flag::register_usize(signal, Arc::clone(&caught.ended_by), number)?;
        signal_hook::flag::register(signal, stop.flag())?;
    }
    Ok(caught)
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
        let signals: SigSet = ENDING.into_iter().chain([Signal::SIGTSTP]).collect();
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
