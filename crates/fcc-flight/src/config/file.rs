//! The bytes of a configuration file.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::Path;

/// The most that a configuration has; the longest in config/ has a hundredth.
const MOST_BYTES: u64 = 1_000_000;

/// Reads a file. What is none is refused before it is opened: a pipe would be
/// waited for, a device may have no end.
pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    let kind = fs::metadata(path)?;
    if kind.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "it is a folder"));
    }
    if !kind.is_file() {
        return Err(Error::new(
            ErrorKind::InvalidInput,
            "it is a pipe or a device, and no file",
        ));
    }
    let mut bytes = Vec::new();
    File::open(path)?
        .take(MOST_BYTES + 1)
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(Error::new(
            ErrorKind::FileTooLarge,
            format!("it has more than {MOST_BYTES} bytes, and no configuration has"),
        ));
    }
    Ok(bytes)
}
