//! The helper's end of the pipe from its daemon.

use std::fs;
use std::io::{self, Read};
use std::os::fd::AsFd;
use std::os::unix::process::parent_id;

use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::signal::Signal;

/// How often the daemon is looked at, should the signal of its end be missed, ms.
const LOOK_EVERY_MS: u16 = 1_000;

/// What the daemon sends through standard input, until it ends.
///
/// The pipe of a process closes with its last thread. A thread that waits for a
/// disk cannot be killed before the disk answers, and until then the pipe of a
/// killed daemon stays open. Its main thread has ended by then: that is the end,
/// too. The kernel reports it by the signal that
/// [`begin_helper`](super::begin_helper) asks for, which interrupts the wait.
///
/// A killed process also stays while a debugger that is stopped itself traces it, or
/// while its cgroup is frozen. Its signal, which nobody can take back, is pending then.
pub(crate) struct DaemonPipe {
    daemon: u32,
}

impl DaemonPipe {
    /// The pipe from this process' parent.
    pub(crate) fn new() -> Self {
        Self {
            daemon: parent_id(),
        }
    }

    /// Whether its main thread has ended, or must.
    fn has_ended(&self) -> bool {
        parent_id() != self.daemon || is_zombie(self.daemon) || is_killed(self.daemon)
    }
}

impl Read for DaemonPipe {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let mut input = io::stdin();
        loop {
            // Before the wait: what was sent before the end is still read.
            let has_ended = self.has_ended();
            let timeout = if has_ended { 0 } else { LOOK_EVERY_MS };
            let mut watched = [PollFd::new(input.as_fd(), PollFlags::POLLIN)];
            match poll(&mut watched, PollTimeout::from(timeout)) {
                Ok(0) if has_ended => return Ok(0),
                Ok(0) | Err(Errno::EINTR) => {}
                Ok(_) => return input.read(into),
                Err(error) => return Err(error.into()),
            }
        }
    }
}

/// Whether the main thread of a process has ended while the process is still
/// there (the third field, `proc_pid_stat(5)`; the second may contain anything).
fn is_zombie(process: u32) -> bool {
    let stat = fs::read(format!("/proc/{process}/stat")).unwrap_or_default();
    let after_name = stat.iter().rposition(|byte| *byte == b')');
    let state = after_name.and_then(|at| stat.get(at + 2));
    matches!(state, Some(b'Z' | b'X'))
}

/// Whether SIGKILL is pending for a process (the masks `SigPnd` and `ShdPnd` in
/// hexadecimal digits, `proc_pid_status(5)`).
fn is_killed(process: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let masks = status.lines().filter_map(|line| {
        let mask = line
            .strip_prefix("SigPnd:")
            .or(line.strip_prefix("ShdPnd:"))?;
        u64::from_str_radix(mask.trim(), 16).ok()
    });
    let killed = 1 << (Signal::SIGKILL as u32 - 1);
    masks.fold(0, |all, mask| all | mask) & killed != 0
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    #[test]
    fn a_process_that_nobody_has_waited_for_is_told_from_one_that_runs() {
        assert!(!is_zombie(std::process::id()));
        let mut ended = Command::new("true").spawn().unwrap();
        let stat = format!("/proc/{}/stat", ended.id());
        while !fs::read_to_string(&stat).unwrap().contains(") Z") {
            std::thread::yield_now();
        }
        assert!(is_zombie(ended.id()));
        ended.wait().unwrap();
    }
}
