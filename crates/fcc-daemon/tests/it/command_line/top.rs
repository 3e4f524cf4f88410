//! `fccd top` on a terminal that is closed or blocked.

use std::fs::File;
use std::os::unix::fs::OpenOptionsExt;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use nix::fcntl::OFlag;
use nix::pty::{PtyMaster, grantpt, posix_openpt, ptsname_r, unlockpt};
use nix::sys::signal::{Signal, kill};
use nix::sys::termios::{FlowArg, tcflow};
use nix::unistd::Pid;

use super::{Flight, PATIENCE, fccd};

/// A terminal: both sides.
struct Terminal {
    ours: PtyMaster,
    theirs: File,
}

pub(super) fn id(child: &Child) -> Pid {
    Pid::from_raw(i32::try_from(child.id()).unwrap())
}

fn ends(child: &mut Child) -> Option<i32> {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code().or(status.signal().map(|n| -n));
        }
        thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    panic!("it does not end");
}

/// A flight, `fccd top` on its own terminal, which has drawn something, and our
/// side of that terminal.
fn watched(folder: &std::path::Path, instance: &str) -> (Flight, Child, Terminal) {
    sized(folder, instance, ["24", "80"])
}

/// Both sides of a terminal of this size.
pub(super) fn terminal([rows, columns]: [&str; 2]) -> (PtyMaster, File) {
    // Closed in every program started here: otherwise each would keep its own
    // terminal open.
    let ours = posix_openpt(OFlag::O_RDWR | OFlag::O_NOCTTY | OFlag::O_CLOEXEC).unwrap();
    grantpt(&ours).unwrap();
    unlockpt(&ours).unwrap();
    let name = ptsname_r(&ours).unwrap();
    let set = Command::new("stty")
        .args(["-F", &name, "rows", rows, "cols", columns])
        .status();
    assert!(set.unwrap().success());
    let theirs = File::options()
        .read(true)
        .write(true)
        .custom_flags(OFlag::O_NOCTTY.bits())
        .open(name)
        .unwrap();
    (ours, theirs)
}

fn sized(
    folder: &std::path::Path,
    instance: &str,
    [rows, columns]: [&str; 2],
) -> (Flight, Child, Terminal) {
    let flight = Flight::start(folder, instance);
    let (ours, theirs) = terminal([rows, columns]);
    let end = || Stdio::from(theirs.try_clone().unwrap());
    let top = fccd(folder, &["top", "--instance", instance])
        .stdin(end())
        .stdout(end())
        .stderr(end())
        .spawn()
        .unwrap();
    let mut bytes = [0; 16];
    nix::unistd::read(&ours, &mut bytes).unwrap();
    (flight, top, Terminal { ours, theirs })
}

#[test]
fn it_ends_with_its_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let (_flight, mut top, terminal) = watched(folder.path(), "top-gone");
    drop((terminal.ours, terminal.theirs));
    assert_eq!(ends(&mut top), Some(1));
}

/// Memory for each of its characters does not exist.
#[test]
fn a_terminal_that_reports_a_huge_size_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (_flight, mut top, _terminal) = sized(folder.path(), "top-huge", ["65535", "65535"]);
    assert_eq!(ends(&mut top), Some(1));
}

#[test]
fn a_signal_ends_it_and_restores_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let (_flight, mut top, _terminal) = watched(folder.path(), "top-ends");
    kill(id(&top), Signal::SIGTERM).unwrap();
    assert_eq!(ends(&mut top), Some(0));
}

/// It waits for the terminal, and cannot restore it.
#[test]
fn a_signal_ends_it_on_a_blocked_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let (_flight, mut top, terminal) = watched(folder.path(), "top-held");
    tcflow(&terminal.theirs, FlowArg::TCOOFF).unwrap();
    thread::sleep(Duration::from_millis(300));
    kill(id(&top), Signal::SIGTERM).unwrap();
    assert_eq!(ends(&mut top), Some(128 + 15));
}
