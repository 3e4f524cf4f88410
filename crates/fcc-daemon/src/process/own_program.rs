//! Starts this program again, as one of its helpers.

use std::fs;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};
use std::sync::Arc;

use nix::sys::signal::Signal;
use nix::sys::stat::{SFlag, fstat};
use signal_hook::consts::{SIGABRT, SIGCONT, SIGHUP, SIGINT, SIGQUIT, SIGTERM};

use super::signals::tolerate;

/// This program, also if its file was replaced meanwhile.
const PROGRAM: &str = "/proc/self/exe";

/// The command for a helper. Its standard input is for the caller to set.
pub(crate) fn own_program(helper: &str) -> Command {
    let mut command = Command::new(PROGRAM);
    command
        .arg0("fccd")
        .arg(helper)
        // A separate process group, so that Ctrl-C does not end it.
        .process_group(0)
        .current_dir("/")
        .stdout(Stdio::null())
        .stderr(messages());
    command
}

/// Where a helper prints. Not into a pipe: its reader would wait for the end of
/// the helper.
fn messages() -> Stdio {
    let is_pipe = fstat(io::stderr()).is_ok_and(|found| {
        SFlag::from_bits_truncate(found.st_mode & SFlag::S_IFMT.bits()) == SFlag::S_IFIFO
    });
    if is_pipe {
        Stdio::null()
    } else {
        Stdio::inherit()
    }
}

/// What a helper does first, while nothing of its own is open: it closes what
/// it inherited, and takes the program's name, which is that of the link. If it
/// is stopped, the kernel continues it when the daemon ends.
pub(crate) fn begin_helper() {
    close_inherited();
    // On the end of the thread that started it, the daemon's main one. If that
    // ended before this call, nothing is sent: this helper runs, and finds it out
    // by its pipe.
    let _ = nix::sys::prctl::set_pdeathsig(Signal::SIGCONT);
    let _ = nix::sys::prctl::set_name(c"fccd");
}

/// A signal to all processes of the daemon does not end this helper: it ends
/// after the daemon. `ABRT` is sent by a service manager's watchdog.
///
/// # Errors
/// When the system refuses.
pub(crate) fn outlive_signals() -> io::Result<()> {
    // CONT wakes it to look whether the daemon has ended.
    [SIGTERM, SIGINT, SIGQUIT, SIGHUP, SIGABRT, SIGCONT]
        .into_iter()
        .try_for_each(|signal| signal_hook::flag::register(signal, Arc::default()).map(drop))?;
    tolerate()
}

/// Closes what this process inherited besides its standard streams, from the
/// daemon or from the program that started that: nobody else's file or
/// connection stays open for as long as this helper lives.
fn close_inherited() {
    let open: Vec<i32> = fs::read_dir("/proc/self/fd")
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| entry.file_name().to_str()?.parse().ok())
        .filter(|number| *number > 2)
        .collect();
    for number in open {
        // The folder's own is closed already.
        let _ = nix::unistd::close(number);
    }
}
