//! Locks that only a program that may write the file can take.
//!
//! flock(2) asks for an open file only: whoever may read a recording could lock
//! it, and so keep its owner from recovering or deleting it. These locks
//! (`F_OFD_SETLK`, fcntl(2)) ask for a file that is open for writing. Who may only
//! read can take a shared lock, which counts for nothing here.

use std::fs::File;
use std::io;

use nix::errno::Errno;
use nix::fcntl::{FcntlArg, fcntl};
use nix::libc;

/// A lock on all of a file.
fn whole(kind: libc::c_int) -> libc::flock {
    libc::flock {
        l_type: kind as libc::c_short,
        l_whence: libc::SEEK_SET as libc::c_short,
        l_start: 0,
        l_len: 0,
        l_pid: 0,
    }
}

/// Locks a file until it is closed; returns whether no other program that may
/// write it has locked it. If one that may only read it has, or this one may only
/// read it itself, it is not locked, and nobody else has.
///
/// # Errors
/// The system's error: not every file system has locks.
pub fn try_lock(file: &File) -> io::Result<bool> {
    match fcntl(file, FcntlArg::F_OFD_SETLK(&whole(libc::F_WRLCK))) {
        Ok(_) => Ok(true),
        Err(Errno::EAGAIN | Errno::EACCES | Errno::EBADF) => Ok(!is_locked(file)),
        Err(error) => Err(error.into()),
    }
}

/// Whether another program that may write the file has locked it.
pub(super) fn is_locked(file: &File) -> bool {
    let mut lock = whole(libc::F_RDLCK);
    fcntl(file, FcntlArg::F_OFD_GETLK(&mut lock)).is_ok()
        && lock.l_type != libc::F_UNLCK as libc::c_short
}

#[cfg(test)]
mod tests {
    use std::fs::{self, OpenOptions, Permissions};
    use std::os::unix::fs::PermissionsExt as _;
    use std::path::Path;

    use super::super::disk::{Disk as _, FileSystem, is_being_written, lock, may_be_deleted};
    use super::super::opening::open_lock;
    use super::*;

    /// The locks that a user can take who may only read the file.
    fn locked_by_a_reader(path: &Path) -> [File; 2] {
        let [first, second] = [File::open(path).unwrap(), File::open(path).unwrap()];
        first.lock().unwrap();
        fcntl(&second, FcntlArg::F_OFD_SETLK(&whole(libc::F_RDLCK))).unwrap();
        [first, second]
    }

    #[test]
    fn who_may_only_read_a_recording_keeps_nobody_from_recovering_or_deleting_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        fs::write(&path, "a recording").unwrap();
        let _reader = locked_by_a_reader(&path);
        assert!(!is_being_written(&path));
        assert!(may_be_deleted(&path));
        assert!(lock(&path).unwrap().is_some());
    }

    #[test]
    fn a_recording_is_locked_while_it_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let writer = FileSystem.create(&path).unwrap();
        assert!(is_being_written(&path));
        assert!(!may_be_deleted(&path));
        assert!(lock(&path).unwrap().is_none());
        drop(writer);
        let recovers = lock(&path).unwrap().unwrap();
        assert!(lock(&path).unwrap().is_none());
        drop(recovers);
        assert!(!is_being_written(&path));
    }

    #[test]
    fn a_file_that_may_not_be_written_is_known_to_be_locked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let writer = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&path)
            .unwrap();
        let reader = File::open(&path).unwrap();
        assert!(try_lock(&reader).unwrap());
        assert!(try_lock(&writer).unwrap());
        assert!(!try_lock(&reader).unwrap());
    }

    #[test]
    fn a_lock_file_is_for_its_owner_only_and_no_reader_locks_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.lock");
        // As earlier versions made it.
        fs::write(&path, "").unwrap();
        fs::set_permissions(&path, Permissions::from_mode(0o644)).unwrap();
        let _reader = locked_by_a_reader(&path);
        let mode = |file: &File| file.metadata().unwrap().permissions().mode() & 0o777;
        let lock = open_lock(&path).unwrap();
        assert!(try_lock(&lock).unwrap());
        assert_eq!(mode(&lock), 0o600);
        fs::remove_file(&path).unwrap();
        assert_eq!(mode(&open_lock(&path).unwrap()), 0o600);
    }
}
