//! Industrial I/O (IIO): the kernel's own drivers for sensors.
//!
//! Where the kernel has a driver for a chip, it is the best choice: it knows the
//! chip's interrupt and FIFO, and its time stamps are those of the samples. A
//! device is a folder, `/sys/bus/iio/devices/iio:device0`, with a file for each
//! value, and for most chips a buffer, `/dev/iio:device0`, from which whole scans
//! are read. With a buffer it is read from there, otherwise file by file.
//!
//! Units and names by Linux, Documentation/ABI/testing/sysfs-bus-iio; buffers by
//! `Documentation/iio/iio_devbuf.rst`.

mod buffer;
mod channels;
mod folder;
mod matrix;
mod polled;
mod scan;
mod scan_type;

use std::io;
use std::path::{Path, PathBuf};

pub use buffer::Buffer;
pub use channels::{Channels, Quantity};
pub use folder::Folder;
pub use matrix::{Matrix, MatrixError};
pub use polled::Polled;
pub use scan::{Element, ScanLayout};
pub use scan_type::{ScanType, ScanTypeError};

use crate::{Clock, DeviceError, RawValues, Sample, Source};

/// Where the kernel shows its devices; other folders in tests.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Roots {
    /// With a folder for each device.
    pub sysfs: PathBuf,
    /// With a character device for each buffer.
    pub dev: PathBuf,
}

impl Default for Roots {
    fn default() -> Self {
        Self {
            sysfs: PathBuf::from("/sys/bus/iio/devices"),
            dev: PathBuf::from("/dev"),
        }
    }
}

/// Which device is read, and how.
#[derive(Clone, Debug)]
pub struct IioConfig {
    /// Where devices are.
    pub roots: Roots,
    /// The device: its name or its label, such as `mpu6050`, or `iio:device0`.
    pub device: String,
    /// Samples in a second.
    pub rate_hz: f64,
    /// Whether its buffer is used, if it has one.
    pub buffered: bool,
    /// Whether its pressure is that of a pitot tube.
    pub is_differential: bool,
    /// What samples without a time stamp of the kernel are stamped with.
    pub clock: Clock,
}

/// A device as it is found.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Found {
    /// `iio:device0`.
    pub node: String,
    /// What its driver calls it.
    pub name: String,
    /// What the board's description calls it, if it does.
    pub label: Option<String>,
}

impl Roots {
    /// All devices, in the order of their numbers.
    ///
    /// # Errors
    /// When the folder cannot be read; without any IIO there is none.
    pub fn devices(&self) -> io::Result<Vec<Found>> {
        let mut found = Vec::new();
        for entry in self.sysfs.read_dir()? {
            let node = entry?.file_name().to_string_lossy().into_owned();
            if node.starts_with("iio:device") {
                let folder = Folder::new(self.sysfs.join(&node));
                found.push(Found {
                    name: folder.text("name").unwrap_or_default(),
                    label: folder.text("label").ok(),
                    node,
                });
            }
        }
        found.sort_by_key(|device| (device.node.len(), device.node.clone()));
        Ok(found)
    }

    /// A device's folder.
    pub(crate) fn folder(&self, node: &str) -> Folder {
        Folder::new(self.sysfs.join(node))
    }
}

/// An open device, read in either way.
#[derive(Debug)]
pub enum Iio {
    /// From its buffer.
    Buffer(Buffer),
    /// File by file.
    Polled(Polled),
}

impl Iio {
    /// Finds a device, and sets it up.
    ///
    /// # Errors
    /// When there is none or more than one of that name, it measures nothing
    /// known, or it refuses its settings.
    pub fn open(config: &IioConfig) -> Result<Self, DeviceError> {
        let node = config.find()?;
        let folder = config.roots.folder(&node);
        let channels = Channels::of(&folder, config.is_differential)?;
        let has_buffer = folder.has("scan_elements") && folder.has("buffer");
        let (rate_hz, clock) = (config.rate_hz, config.clock.clone());
        if config.buffered && has_buffer && channels.are_raw() {
            let character = config.roots.dev.join(&node);
            return Buffer::open(folder, channels, character, rate_hz, clock).map(Self::Buffer);
        }
        Polled::new(folder, channels, rate_hz, clock).map(Self::Polled)
    }
}

impl Source for Iio {
    type Value = RawValues;

    fn read(&mut self) -> Result<Option<Sample<RawValues>>, DeviceError> {
        match self {
            Self::Buffer(buffer) => buffer.read(),
            Self::Polled(polled) => polled.read(),
        }
    }
}

impl IioConfig {
    /// The folder of the only device with that name.
    ///
    /// # Errors
    /// When there is none or more than one of that name.
    pub fn folder(&self) -> Result<PathBuf, DeviceError> {
        Ok(self.roots.sysfs.join(self.find()?))
    }

    /// The node of the only device with that name.
    fn find(&self) -> Result<String, DeviceError> {
        let sysfs = &self.roots.sysfs;
        let all = self.roots.devices().map_err(|source| DeviceError::Open {
            device: sysfs.display().to_string(),
            source,
        })?;
        let is_it = |found: &&Found| {
            let names = [Some(&found.node), Some(&found.name), found.label.as_ref()];
            names.contains(&Some(&self.device))
        };
        let those: Vec<&Found> = all.iter().filter(is_it).collect();
        match those.as_slice() {
            [only] => Ok(only.node.clone()),
            [] => Err(no_such_device(sysfs, &self.device, &all)),
            several => Err(DeviceError::Refused {
                device: sysfs.display().to_string(),
                what: format!(
                    "{} devices are called \"{}\": give one of {}",
                    several.len(),
                    self.device,
                    listed(several.iter().map(|found| found.node.as_str())),
                ),
            }),
        }
    }
}

fn no_such_device(sysfs: &Path, wanted: &str, all: &[Found]) -> DeviceError {
    let there = if all.is_empty() {
        "no device at all: load the chip's driver, by an overlay of the device tree (docs/boards.md)"
            .to_owned()
    } else {
        let names = all.iter().map(|found| found.name.as_str());
        format!("only {}", listed(names))
    };
    DeviceError::Refused {
        device: sysfs.display().to_string(),
        what: format!("no device is called {wanted:?}, there is {there}"),
    }
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
