//! Claims of devices: two daemons, or two entries of a configuration, would write
//! different pulses to one servo, and take each other's bytes from one line.
//!
//! A claim is a lock of the device's file (`F_OFD_SETLK`, fcntl(2)), which ends with
//! the daemon. It is known to programs that ask for it only.

use std::fs::{File, OpenOptions};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

use nix::errno::Errno;
use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::libc::{self, c_short};

use crate::DeviceError;

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
            what: "another fccd on this machine has it, or another entry of this configuration: \
                   end that one first, or choose another device"
                .to_owned(),
        }),
        // Not every file system has locks.
        _ => Ok(()),
    }
}
