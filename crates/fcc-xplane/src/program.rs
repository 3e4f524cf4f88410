//! The program that has a port of this machine (proc(5)).
//!
//! A port that is closed is not the end of a simulator: it may open another one, or a
//! relay before it may be started again, and its controls stay held. That the process
//! is gone is.

use std::fs;
use std::path::Path;

/// Of the fields of `/proc/PID/stat` after the name in parentheses: the state, and the
/// time of the start in clock ticks (fields 3 and 22).
const STATE: usize = 0;
const STARTED: usize = 19;

/// A process that has a socket. Its number may be given to another one later, which
/// has another time of start.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Program {
    process: u32,
    started: u64,
}

impl Program {
    /// The process that has the socket with this inode; none if it belongs to another
    /// user, whose descriptors only root may list. Not in a tick.
    pub(crate) fn with_socket(inode: u64) -> Option<Self> {
        let link = format!("socket:[{inode}]");
        let processes = fs::read_dir("/proc").ok()?.flatten();
        processes
            .filter(|entry| has_open(&entry.path(), &link))
            .find_map(|entry| Self::of(entry.file_name().to_str()?.parse().ok()?))
    }

    /// The process with this number.
    pub(crate) fn of(process: u32) -> Option<Self> {
        let started = started(process)?;
        Some(Self { process, started })
    }

    /// Whether the process is gone, or only its exit code is still there.
    pub(crate) fn has_ended(&self) -> bool {
        started(self.process) != Some(self.started)
    }
}

fn has_open(process: &Path, link: &str) -> bool {
    let open = fs::read_dir(process.join("fd")).into_iter().flatten();
    open.flatten()
        .filter_map(|entry| fs::read_link(entry.path()).ok())
        .any(|target| target.as_os_str() == link)
}

/// When a process was started, unless it has ended.
fn started(process: u32) -> Option<u64> {
    let folder = format!("/proc/{process}");
    let (has_ended, started) = state(Path::new(&folder))?;
    // Other threads may outlive the first one.
    let lives = |thread: &Path| state(thread).is_some_and(|(has_ended, _)| !has_ended);
    let mut threads = fs::read_dir(format!("{folder}/task")).into_iter().flatten();
    let is_gone = has_ended && !threads.any(|entry| entry.is_ok_and(|entry| lives(&entry.path())));
    (!is_gone).then_some(started)
}

/// Whether a process or thread has ended, and when it was started.
fn state(folder: &Path) -> Option<(bool, u64)> {
    let stat = fs::read(folder.join("stat")).ok()?;
    let stat = String::from_utf8_lossy(&stat);
    // Its name may contain anything.
    let (_, rest) = stat.rsplit_once(')')?;
    let fields: Vec<&str> = rest.split_ascii_whitespace().collect();
    let has_ended = matches!(*fields.get(STATE)?, "Z" | "X");
    Some((has_ended, fields.get(STARTED)?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use std::net::UdpSocket;
    use std::os::unix::fs::MetadataExt as _;
    use std::process::Command;
    use std::time::{Duration, Instant};

    use super::*;

    #[test]
    fn a_program_is_found_by_its_socket_and_ends_with_its_process() {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let inode = |socket: &UdpSocket| {
            let descriptor = std::os::fd::AsRawFd::as_raw_fd(socket);
            fs::metadata(format!("/proc/self/fd/{descriptor}"))
                .unwrap()
                .ino()
        };
        let own = Program::with_socket(inode(&socket)).unwrap();
        assert_eq!(own.process, std::process::id());
        drop(socket);
        assert!(!own.has_ended(), "a port that is closed is no end");

        // It ends its first thread, and another one goes on.
        let script = "import ctypes, platform, threading, time\n\
                      threading.Thread(target=time.sleep, args=(60,)).start()\n\
                      ctypes.CDLL(None).syscall(\n\
                      60 if platform.machine() == 'x86_64' else 93, 0)";
        let mut child = Command::new("python3")
            .args(["-c", script])
            .spawn()
            .unwrap();
        let folder = format!("/proc/{}", child.id());
        let program = Program::of(child.id()).unwrap();
        let began = Instant::now();
        while !state(Path::new(&folder)).unwrap().0 {
            assert!(began.elapsed() < Duration::from_secs(30), "no python3?");
        }
        assert!(!program.has_ended(), "its other thread goes on");
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(program.has_ended());

        let mut child = Command::new("sleep").arg("60").spawn().unwrap();
        let program = Program::of(child.id()).unwrap();
        assert!(!program.has_ended());
        child.kill().unwrap();
        while !program.has_ended() {}
        child.wait().unwrap();
        assert!(program.has_ended());
    }
}
