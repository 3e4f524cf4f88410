//! A serial line of the operating system.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

use nix::errno::Errno;
use nix::fcntl::OFlag;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::termios::{
    ControlModes, InputModes, OptionalActions, QueueSelector, Termios, ioctl_tiocexcl, tcflush,
    tcgetattr, tcsetattr,
};

use crate::claim::claim_file;
use crate::traffic::Traffic;
use crate::{DeviceError, WAIT};

/// A driver that cannot divide its clock down to a rate comes close to it; a
/// receiver samples each bit in its middle, and tolerates this much over ten bits.
const BAUD_TOLERANCE: f64 = 0.02;

/// How a line is set. Always 8 data bits, and no flow control.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LineSettings {
    /// Such as `/dev/ttyAMA0`, or a name under `/dev/serial/by-id`.
    pub path: PathBuf,
    /// Bits in a second, any number.
    pub baud: u32,
    /// Even parity and two stop bits, instead of none and one. Bytes with the wrong
    /// parity are left out.
    pub has_even_parity: bool,
}

/// An open line, which no other program opens meanwhile.
#[derive(Debug)]
pub struct SerialLine {
    file: File,
    path: PathBuf,
    traffic: Traffic,
}

impl SerialLine {
    /// Opens a line, and discards what arrived before.
    ///
    /// # Errors
    /// When it cannot be opened or set, or does not come within 2 % of the rate.
    pub fn open(settings: &LineSettings) -> Result<Self, DeviceError> {
        let path = settings.path.clone();
        let opened = OpenOptions::new()
            .read(true)
            .write(true)
            // Without waiting for a modem's carrier.
            .custom_flags((OFlag::O_NOCTTY | OFlag::O_NONBLOCK).bits())
            .open(&path);
        let file = opened.map_err(|source| DeviceError::Open {
            device: path.display().to_string(),
            source,
        })?;
        let traffic = Traffic::begin();
        let line = Self {
            file,
            path,
            traffic,
        };
        line.set(settings)?;
        Ok(line)
    }

    fn set(&self, settings: &LineSettings) -> Result<(), DeviceError> {
        let doing = |doing| move |source: rustix::io::Errno| self.error(doing, source.into());
        // Root may open an exclusive line, too.
        claim_file(&self.file, &self.path, 0)?;
        ioctl_tiocexcl(&self.file).map_err(doing("claiming the line for this program"))?;
        let mut modes = tcgetattr(&self.file).map_err(doing("reading the line's settings"))?;
        raw(&mut modes, settings.has_even_parity);
        modes
            .set_speed(settings.baud)
            .and_then(|()| tcsetattr(&self.file, OptionalActions::Now, &modes))
            .and_then(|()| tcflush(&self.file, QueueSelector::IOFlush))
            .map_err(doing("setting the line"))?;
        let set = tcgetattr(&self.file).map_err(doing("reading the line's settings"))?;
        let (asked, has) = (f64::from(settings.baud), f64::from(set.input_speed()));
        if (has - asked).abs() > asked * BAUD_TOLERANCE {
            return Err(DeviceError::Refused {
                device: self.path.display().to_string(),
                what: format!(
                    "it runs at {has} baud instead of {asked}: choose a rate that it can, or \
                     another line (docs/boards.md)"
                ),
            });
        }
        Ok(())
    }

    /// Waits for bytes at most [`WAIT`]; how many there are, 0 if there are none.
    ///
    /// # Errors
    /// When the line is gone, such as an unplugged adapter's, and when more than
    /// 1,000,000 bytes arrive in a second.
    pub fn read(&mut self, into: &mut [u8]) -> Result<usize, DeviceError> {
        let wait = Timespec {
            tv_sec: WAIT.as_secs().cast_signed(),
            tv_nsec: WAIT.subsec_nanos().into(),
        };
        let mut polled = [PollFd::new(&self.file, PollFlags::IN)];
        let ready = poll(&mut polled, Some(&wait));
        let is_interrupted = ready == Err(rustix::io::Errno::INTR);
        if is_interrupted || ready.map_err(|error| self.error("waiting", error.into()))? == 0 {
            return Ok(0);
        }
        match self.file.read(into) {
            // A line that was hung up is at its end.
            Ok(0) => Err(self.error("reading", Errno::ENODEV.into())),
            // A device at USB keeps no rate of a line.
            Ok(length) if self.traffic.is_flood(length, 0) => Err(DeviceError::Refused {
                device: self.path.display().to_string(),
                what: format!(
                    "it sends more than {} bytes in a second, and no receiver does: check which \
                     device has this path (`ls -l /dev/serial/by-id`)",
                    Traffic::MOST_BYTES
                ),
            }),
            Ok(length) => Ok(length),
            Err(error) if is_nothing(&error) => Ok(0),
            Err(error) => Err(self.error("reading", error)),
        }
    }

    /// Sends bytes, if the line's buffer has room for them; false if it has not.
    ///
    /// # Errors
    /// When the line is gone.
    pub fn write(&mut self, bytes: &[u8]) -> Result<bool, DeviceError> {
        match self.file.write(bytes) {
            Ok(length) => Ok(length == bytes.len()),
            Err(error) if is_nothing(&error) => Ok(false),
            Err(error) => Err(self.error("writing", error)),
        }
    }

    /// Which line this is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn error(&self, doing: &'static str, source: io::Error) -> DeviceError {
        DeviceError::Io {
            device: self.path.display().to_string(),
            doing,
            source,
        }
    }
}

fn is_nothing(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}

/// Bytes as they are, in both directions.
fn raw(modes: &mut Termios, has_even_parity: bool) {
    modes.make_raw();
    let (parity, stop) = (
        ControlModes::PARENB | ControlModes::PARODD,
        ControlModes::CSTOPB,
    );
    modes.control_modes -= parity | stop | ControlModes::CRTSCTS | ControlModes::HUPCL;
    modes.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD;
    modes.input_modes |= InputModes::IGNBRK;
    if has_even_parity {
        modes.control_modes |= ControlModes::PARENB | stop;
        modes.input_modes |= InputModes::INPCK | InputModes::IGNPAR;
    }
}
