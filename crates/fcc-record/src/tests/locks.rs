//! Who may only read a recording or a lock file does not lock it.

use std::fs::{self, File, Permissions};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::thread;
use std::time::Duration;

use fcc_telemetry::file_lock::{try_lock, whole_file};
use nix::fcntl::{FcntlArg, fcntl};
use nix::libc;

use super::disk::{Disk as _, FileSystem, is_being_written, lock, may_be_deleted};
use super::opening::open_lock;

/// The locks that a user can take who may only read the file.
fn locked_by_a_reader(path: &Path) -> [File; 2] {
    let [first, second] = [File::open(path).unwrap(), File::open(path).unwrap()];
    first.lock().unwrap();
    fcntl(&second, FcntlArg::F_OFD_SETLK(&whole_file(libc::F_RDLCK))).unwrap();
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
    let recovers = soon(|| lock(&path).unwrap());
    assert!(lock(&path).unwrap().is_none());
    drop(recovers);
    soon(|| (!is_being_written(&path)).then_some(()));
}

/// A process that another test starts has a copy of a locked file until it runs its program.
fn soon<T>(mut found: impl FnMut() -> Option<T>) -> T {
    for _ in 0..1_000 {
        if let Some(found) = found() {
            return found;
        }
        thread::sleep(Duration::from_millis(1));
    }
    panic!("not within a second");
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
