//! How a daemon that takes control ends the release helper of one that was
//! killed.
//!
//! A release helper repeats the release until the plant confirms it, for up to
//! two minutes. It would thereby take control from a daemon that was started
//! again and flies. So a helper locks a file named after the plant from the
//! moment it is told that control is held. The kernel tells who has locked a
//! file (`F_GETLK`, fcntl(2)); a program that takes control kills that process,
//! which works also if it is stopped. Nobody connects to anybody, so nobody
//! waits; only this user can open the file, and only processes of this user can
//! be killed.

use std::fs::{self, File};
use std::io;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use fcc_core::framework::PlantId;
use fcc_telemetry::RunFolder;
use fcc_telemetry::file_lock::whole_file;
use nix::fcntl::{FcntlArg, fcntl};
use nix::libc;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use super::plant_file;

/// How long the end of a killed helper is waited for.
const ENDS_WITHIN: Duration = Duration::from_millis(200);
const LOOK_EVERY: Duration = Duration::from_millis(1);

/// The command of a release helper.
pub(super) const RELEASE_HELPER: &str = "release-helper";

fn name(plant: &PlantId) -> String {
    format!("{}.helper", plant_file::name(plant))
}

/// The lock of a helper, while the file is open.
pub(super) struct HelperLock {
    plant: PlantId,
    file: File,
    path: PathBuf,
}

impl HelperLock {
    /// Opens the file; without it, this helper cannot be ended.
    pub(super) fn of(folder: &RunFolder, plant: PlantId) -> Option<Self> {
        let name = name(&plant);
        let file = folder.open(&name).ok()?;
        let path = folder.path(&name);
        let this = Self { plant, file, path };
        this.lock();
        Some(this)
    }

    /// Whether this is the lock for a plant, where the next daemon looks for it.
    pub(super) fn is_of(&self, plant: PlantId) -> bool {
        self.plant == plant && plant_file::is_in_place(&self.file, &self.path)
    }

    /// Locks the file, unless another helper has locked it: that one is ended
    /// first.
    pub(super) fn lock(&self) {
        let _ = fcntl(&self.file, FcntlArg::F_SETLK(&whole_file(libc::F_WRLCK)));
    }
}

/// The process that has locked the file of a plant, unless it is `except`.
fn helper_of(file: &File, except: Option<u32>) -> Option<Pid> {
    let mut lock = whole_file(libc::F_WRLCK);
    fcntl(file, FcntlArg::F_GETLK(&mut lock)).ok()?;
    let is_locked = lock.l_type != libc::F_UNLCK as libc::c_short;
    // Not positive: of another namespace of processes.
    let is_other = lock.l_pid > 1 && u32::try_from(lock.l_pid).ok() != except;
    (is_locked && is_other && may_be_helper(lock.l_pid)).then(|| Pid::from_raw(lock.l_pid))
}

/// Whether a process is a release helper, by its command line; if that cannot be read,
/// it may be. Another program of this user that has locked the file is let alone.
fn may_be_helper(process: i32) -> bool {
    let words = fs::read(format!("/proc/{process}/cmdline"));
    words.map_or(true, |words| {
        words
            .split(|byte| *byte == 0)
            .any(|word| word == RELEASE_HELPER.as_bytes())
    })
}

/// Ends the helper that releases, or would release, `plant`, if there is one
/// other than `ours`; waits at most a fifth of a second. Returns whether there
/// was one.
///
/// # Errors
/// When it does not end: it may release the controls.
pub(super) fn end_helper(
    folder: &RunFolder,
    plant: &PlantId,
    ours: Option<u32>,
) -> io::Result<bool> {
    let Ok(file) = folder.open(&name(plant)) else {
        return Ok(false);
    };
    let mut found = false;
    let until = Instant::now() + ENDS_WITHIN;
    while let Some(helper) = helper_of(&file, ours) {
        found = true;
        kill(helper, Signal::SIGKILL)?;
        if Instant::now() > until {
            return Err(io::ErrorKind::TimedOut.into());
        }
        thread::sleep(LOOK_EVERY);
    }
    Ok(found)
}

/// Removes the file of a plant, if no helper uses it.
pub(super) fn remove_file(folder: &RunFolder, plant: &PlantId) {
    let name = name(plant);
    if folder
        .open(&name)
        .is_ok_and(|file| helper_of(&file, None).is_none())
    {
        let _ = fs::remove_file(folder.path(&name));
    }
}
