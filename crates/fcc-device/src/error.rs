//! What can go wrong with a device.

use core::time::Duration;
use std::io;

use fcc_core::framework::SensorFault;
use nix::errno::Errno;

/// Why a device cannot be opened or read: what, where, and what to do.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum DeviceError {
    /// It cannot be opened.
    #[error("cannot open {device}: {source}{}", advice(source))]
    Open {
        /// Which, by its path and address.
        device: String,
        /// The operating system's error.
        source: io::Error,
    },
    /// It cannot be read or written.
    #[error("{device}: {doing}: {source}{}", advice(source))]
    Io {
        /// Which, by its path and address.
        device: String,
        /// What was being done.
        doing: &'static str,
        /// The operating system's error.
        source: io::Error,
    },
    /// There is something else at its address.
    #[error(
        "{device}: this is no {expected}: its register {register:#04x} has {found:#04x}; check \
         `kind` and the address, `fccd probe` lists what is connected"
    )]
    WrongChip {
        /// Where.
        device: String,
        /// What was expected, and by which numbers.
        expected: String,
        /// The register that identifies it.
        register: u8,
        /// What that register has.
        found: u8,
    },
    /// It is set to what it cannot do, or does not keep what was written.
    #[error("{device}: {what}")]
    Refused {
        /// Which, by its path and address.
        device: String,
        /// What is impossible, and what to choose instead.
        what: String,
    },
    /// Its time stamps are of no clock that is known here.
    #[error(
        "{device}: its time stamps are of no known clock: the youngest was {age_s:.3} s old when \
         it arrived"
    )]
    WrongClock {
        /// Which.
        device: String,
        /// How old the youngest stamp was, s; negative if it was of the future.
        age_s: f64,
    },
    /// It gives nothing any more.
    #[error("{device}: it has given nothing for {} s, and is opened anew", after.as_secs_f64())]
    Stalled {
        /// Which.
        device: String,
        /// For how long.
        after: Duration,
    },
    /// What it gave is not valid: a wrong checksum, a value out of range.
    #[error("{device}: {what}")]
    Malformed {
        /// Which, by its path and address.
        device: String,
        /// What is wrong with it.
        what: &'static str,
    },
}

impl DeviceError {
    /// The same for the loop.
    pub fn fault(&self) -> SensorFault {
        match self {
            Self::Malformed { .. } | Self::WrongClock { .. } => SensorFault::Malformed,
            Self::Stalled { .. } => SensorFault::Silent,
            _ => SensorFault::Io {
                errno: self.errno(),
            },
        }
    }

    /// The operating system's number of the error, or the one that is closest.
    pub fn errno(&self) -> i32 {
        match self {
            Self::Open { source, .. } | Self::Io { source, .. } => {
                source.raw_os_error().unwrap_or(Errno::EIO as i32)
            }
            Self::WrongChip { .. } | Self::Refused { .. } => Errno::ENODEV as i32,
            Self::Stalled { .. } => Errno::ETIMEDOUT as i32,
            Self::Malformed { .. } | Self::WrongClock { .. } => Errno::EBADMSG as i32,
        }
    }
}

/// What to do about an error of the operating system.
fn advice(error: &io::Error) -> &'static str {
    match error.raw_os_error().map(Errno::from_raw) {
        Some(Errno::ENOENT) => {
            "; check the path, and that the bus or the serial line is switched on (docs/boards.md)"
        }
        Some(Errno::EACCES | Errno::EPERM) => {
            "; add the user to the device's group (`ls -l` shows it), and log in again"
        }
        Some(Errno::EBUSY) => {
            "; another program or a driver of the kernel has it: end that program; use that driver \
             (kind = \"iio\"), or unload it"
        }
        Some(Errno::ECONNREFUSED) => "; nothing listens there: start it, and check the address",
        Some(Errno::ECONNRESET) => "; it has ended or closed the connection: see its log",
        Some(Errno::ENXIO | Errno::EREMOTEIO | Errno::ENODEV | Errno::ETIMEDOUT) => {
            "; nothing answers there: check wiring, power and address"
        }
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_says_what_where_and_what_to_do() {
        let missing = DeviceError::Open {
            device: "/dev/i2c-7".into(),
            source: Errno::ENOENT.into(),
        };
        assert_eq!(
            missing.to_string(),
            "cannot open /dev/i2c-7: No such file or directory (os error 2); check the path, and \
             that the bus or the serial line is switched on (docs/boards.md)"
        );
        assert_eq!(missing.fault(), SensorFault::Io { errno: 2 });
        let silent = DeviceError::Io {
            device: "/dev/i2c-1, address 0x68".into(),
            doing: "reading WHO_AM_I",
            source: Errno::EREMOTEIO.into(),
        };
        assert_eq!(
            silent.to_string(),
            "/dev/i2c-1, address 0x68: reading WHO_AM_I: Remote I/O error (os error 121); nothing \
             answers there: check wiring, power and address"
        );
    }
}
