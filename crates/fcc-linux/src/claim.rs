//! Claims of devices: two daemons, or two entries of a configuration, would write
//! different pulses to one servo, and take each other's bytes from one line.
//!
//! A claim is a lock of the device's file (`F_OFD_SETLK`, fcntl(2)), which ends with
//! the daemon. It is known to programs that ask for it only.

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use nix::errno::Errno;
use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::libc::{self, c_short};

use crate::DeviceError;

/// What is said of a device that is not free.
const TAKEN: &str = "another fccd on this machine has it, or another entry of this configuration: \
                     end that one first, or choose another device";

/// The devices that entries of this process have, by their paths without links.
static OWNED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// The device of one entry of a configuration: no other entry has the same one, by
/// whatever name or link, as long as this lives, and so also while it is unplugged or
/// opened anew.
#[derive(Debug, Default)]
pub struct DeviceOwner(Option<PathBuf>);

impl DeviceOwner {
    /// Claims the device that a path leads to now; one that was claimed before under
    /// another path is free again. What is not there is not claimed.
    ///
    /// # Errors
    /// When another entry has it.
    pub fn claim(&mut self, path: &Path) -> Result<(), DeviceError> {
        let Ok(real) = path.canonicalize() else {
            return Ok(());
        };
        if self.0.as_ref() == Some(&real) {
            return Ok(());
        }
        if !owned().insert(real.clone()) {
            return Err(DeviceError::Refused {
                device: path.display().to_string(),
                what: TAKEN.to_owned(),
            });
        }
        self.release();
        self.0 = Some(real);
        Ok(())
    }

    fn release(&mut self) {
        if let Some(before) = self.0.take() {
            owned().remove(&before);
        }
    }
}

impl Drop for DeviceOwner {
    fn drop(&mut self) {
        self.release();
    }
}

fn owned() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    OWNED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Claims a part of a device, such as an address on a bus, until the returned file
/// is dropped.
///
/// # Errors
/// When it cannot be opened, or is claimed already.
pub(crate) fn claim(path: &Path, part: u16) -> Result<File, DeviceError> {
    let opened = OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags((OFlag::O_NOCTTY | OFlag::O_NONBLOCK).bits())
        .open(path);
    let file = opened.map_err(|source| DeviceError::Open {
        device: path.display().to_string(),
        source,
    })?;
    claim_file(&file, path, part)?;
    Ok(file)
}

/// The same of a device that is open, for as long as it is.
///
/// # Errors
/// When it is claimed already.
pub(crate) fn claim_file(file: &File, path: &Path, part: u16) -> Result<(), DeviceError> {
    let byte = libc::flock {
        l_type: libc::F_WRLCK as c_short,
        l_whence: libc::SEEK_SET as c_short,
        l_start: part.into(),
        l_len: 1,
        // fcntl(2): 0, or it is refused.
        l_pid: 0,
    };
    match fcntl(file, FcntlArg::F_OFD_SETLK(&byte)) {
        Err(Errno::EAGAIN | Errno::EACCES) => Err(DeviceError::Refused {
            device: path.display().to_string(),
            what: TAKEN.to_owned(),
        }),
        // Not every file system has locks.
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_has_one_owner_by_whatever_path() {
        let folder = tempfile::tempdir().unwrap();
        let device = folder.path().join("tty0");
        let link = folder.path().join("gnss");
        std::fs::write(&device, "").unwrap();
        std::os::unix::fs::symlink(&device, &link).unwrap();
        let (mut first, mut second) = (DeviceOwner::default(), DeviceOwner::default());
        first.claim(&link).unwrap();
        first.claim(&device).unwrap();
        let twice = folder.path().join("./tty0");
        let refused = second.claim(&twice).unwrap_err().to_string();
        assert!(
            refused.contains("another entry of this configuration"),
            "{refused}"
        );
        // Unplugged, it is still that of the first.
        std::fs::remove_file(&device).unwrap();
        first.claim(&link).unwrap();
        std::fs::write(&device, "").unwrap();
        second.claim(&device).unwrap_err();
        drop(first);
        second.claim(&device).unwrap();
    }
}
