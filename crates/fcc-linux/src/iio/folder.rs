//! The files of a device.

use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::PathBuf;

use nix::fcntl::OFlag;

use crate::DeviceError;

/// Files of sysfs are no longer than a page.
const MOST_BYTES: u64 = 4096;

/// The folder of a device, with a file for each value and each setting.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// A device's folder.
    pub fn new(path: PathBuf) -> Self {
        Self(path)
    }

    /// Its path.
    pub fn shown(&self) -> String {
        self.0.display().to_string()
    }

    /// Whether there is a file or a folder.
    pub fn has(&self, name: &str) -> bool {
        self.0.join(name).exists()
    }

    /// Reads a file, without the end of its line.
    ///
    /// # Errors
    /// When it cannot be read, is no regular file, or no text.
    pub fn text(&self, name: &str) -> io::Result<String> {
        let mut text = String::new();
        // A named pipe in the file's place is not waited for.
        let file = OpenOptions::new()
            .read(true)
            .custom_flags(OFlag::O_NONBLOCK.bits())
            .open(self.0.join(name))?;
        if !file.metadata()?.is_file() {
            return Err(io::Error::other(
                "it is no regular file, as those of the kernel are: check the folder (`ls -l`)",
            ));
        }
        file.take(MOST_BYTES).read_to_string(&mut text)?;
        Ok(text.trim_end().to_owned())
    }

    /// Reads a finite number.
    ///
    /// # Errors
    /// When the file cannot be read, or has no number.
    pub fn number(&self, name: &str) -> Result<f64, DeviceError> {
        let text = self
            .text(name)
            .map_err(|source| self.failed(name, "reading", source))?;
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| DeviceError::Malformed {
            device: self.shown_file(name),
            what: "is no number",
        })
    }

    /// The number in the first of the files that is there, or a default.
    ///
    /// # Errors
    /// When the file cannot be read, or has no number.
    pub fn number_or(&self, names: &[&str], default: f64) -> Result<f64, DeviceError> {
        let there = names.iter().find(|name| self.has(name));
        there.map_or(Ok(default), |name| self.number(name))
    }

    /// Writes a setting.
    ///
    /// # Errors
    /// When the kernel refuses it.
    pub fn write(&self, name: &str, text: &str) -> Result<(), DeviceError> {
        fs::write(self.0.join(name), text).map_err(|source| match source.kind() {
            ErrorKind::PermissionDenied => DeviceError::Refused {
                device: self.shown_file(name),
                what: "may not be written: give the right to it by a rule of udev, or set \
                       buffered = false (docs/boards.md)"
                    .to_owned(),
            },
            _ => self.failed(name, "writing", source),
        })
    }

    /// The names in a folder within; none if it cannot be read.
    pub(super) fn files(&self, within: &str) -> Vec<String> {
        let entries = self.0.join(within).read_dir().into_iter().flatten();
        entries
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .collect()
    }

    /// The trigger of this device, whose name ends with the device's number, as
    /// drivers call theirs: `mpu6050-dev0` of `iio:device0`.
    pub(super) fn own_trigger(&self) -> Option<String> {
        let node = self.0.file_name()?.to_str()?;
        let ending = format!("-dev{}", node.strip_prefix("iio:device")?);
        let devices = Self::new(self.0.parent()?.to_owned());
        let triggers = devices.files(".").into_iter();
        triggers
            .filter(|entry| entry.starts_with("trigger"))
            .filter_map(|entry| devices.text(&format!("{entry}/name")).ok())
            .find(|name| name.ends_with(&ending))
    }

    pub(super) fn failed(&self, name: &str, doing: &'static str, source: io::Error) -> DeviceError {
        DeviceError::Io {
            device: self.shown_file(name),
            doing,
            source,
        }
    }

    fn shown_file(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
}
