//! A serial line of the operating system.

use core::fmt;
use core::str::FromStr;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;

use nix::libc;
use nix::sys::termios::{
    BaudRate, ControlFlags, FlushArg, SetArg, SpecialCharacterIndices, cfmakeraw, cfsetspeed,
    tcflush, tcgetattr, tcsetattr,
};

/// The speed of a serial line, bits a second.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs, reason = "the names are the speeds")]
pub enum Baud {
    B57600,
    B115200,
    B230400,
    B460800,
    B921600,
    B1000000,
}

/// No speed of [`Baud`].
#[derive(thiserror::Error, Clone, Copy, PartialEq, Eq, Debug)]
#[error("choose 57600, 115200, 230400, 460800, 921600 or 1000000")]
pub struct NoSuchBaud;

impl Baud {
    const ALL: [(Self, u32, BaudRate); 6] = [
        (Self::B57600, 57_600, BaudRate::B57600),
        (Self::B115200, 115_200, BaudRate::B115200),
        (Self::B230400, 230_400, BaudRate::B230400),
        (Self::B460800, 460_800, BaudRate::B460800),
        (Self::B921600, 921_600, BaudRate::B921600),
        (Self::B1000000, 1_000_000, BaudRate::B1000000),
    ];

    /// Bits a second; a byte takes ten.
    pub fn bits_per_s(self) -> u32 {
        let this = Self::ALL.iter().find(|(baud, ..)| *baud == self);
        this.map_or(0, |(_, bits_per_s, _)| *bits_per_s)
    }
}

impl TryFrom<u32> for Baud {
    type Error = NoSuchBaud;

    fn try_from(bits_per_s: u32) -> Result<Self, NoSuchBaud> {
        let this = Self::ALL.iter().find(|(_, bits, _)| *bits == bits_per_s);
        this.map(|(baud, ..)| *baud).ok_or(NoSuchBaud)
    }
}

impl fmt::Display for Baud {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.bits_per_s().fmt(f)
    }
}

impl FromStr for Baud {
    type Err = NoSuchBaud;

    fn from_str(text: &str) -> Result<Self, NoSuchBaud> {
        Self::try_from(text.parse::<u32>().map_err(|_| NoSuchBaud)?)
    }
}

/// Opens a line for this program alone: bytes as they are, without waiting.
pub(crate) fn open(path: &Path, baud: Baud) -> io::Result<File> {
    let tty = OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags(libc::O_NOCTTY | libc::O_NONBLOCK)
        .open(path)?;
    match tty.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Err(io::ErrorKind::ResourceBusy.into()),
        Err(TryLockError::Error(error)) => return Err(error),
    }
    let mut settings = tcgetattr(&tty)?;
    cfmakeraw(&mut settings);
    if let Some((_, _, rate)) = Baud::ALL.iter().find(|(of, ..)| *of == baud) {
        cfsetspeed(&mut settings, *rate)?;
    }
    settings
        .control_flags
        .insert(ControlFlags::CLOCAL | ControlFlags::CREAD);
    settings
        .control_flags
        .remove(ControlFlags::CSTOPB | ControlFlags::CRTSCTS | ControlFlags::HUPCL);
    // So that a read of nothing is the end of the line.
    if let Some(least) = settings
        .control_chars
        .get_mut(SpecialCharacterIndices::VMIN as usize)
    {
        *least = 1;
    }
    tcsetattr(&tty, SetArg::TCSANOW, &settings)?;
    // What waited is of another time.
    tcflush(&tty, FlushArg::TCIOFLUSH)?;
    Ok(tty)
}
