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

/// A lock on all of a file, of a kind of fcntl(2).
pub fn whole_file(kind: libc::c_int) -> libc::flock {
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
    match fcntl(file, FcntlArg::F_OFD_SETLK(&whole_file(libc::F_WRLCK))) {
        Ok(_) => Ok(true),
        Err(Errno::EAGAIN | Errno::EACCES | Errno::EBADF) => Ok(!is_locked(file)),
        Err(error) => Err(error.into()),
    }
}

/// Whether another program that may write the file has locked it.
pub fn is_locked(file: &File) -> bool {
    let mut lock = whole_file(libc::F_RDLCK);
    fcntl(file, FcntlArg::F_OFD_GETLK(&mut lock)).is_ok()
        && lock.l_type != libc::F_UNLCK as libc::c_short
}

#[cfg(test)]
mod tests {
    use std::fs::OpenOptions;

    use super::*;

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
}
