//! A device with a buffer, from which whole scans are read.

use core::time::Duration;
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::os::fd::AsFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::PathBuf;

use fcc_core::framework::Time;
use nix::errno::Errno;
use nix::libc;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};

use super::{Channels, Folder, ScanLayout, ScanType};
use crate::{Clock, DeviceError, Measured, RawValues, Sample, Source, WAIT};

/// Scans that the kernel keeps: a second of a fast chip.
const KEPT_SCANS: &str = "1024";
/// Bytes read at once.
const READ_BYTES: usize = 16 * 1024;
/// How far from now a time stamp may be: one that is further away is of another
/// clock.
const LATEST: Duration = Duration::from_secs(2);

/// A device whose scans are read from its buffer.
///
/// The kernel stamps each scan, on the loop's clock if the driver can; a device
/// without time stamps has the time at which its scans were read.
#[derive(Debug)]
pub struct Buffer {
    folder: Folder,
    channels: Channels,
    path: PathBuf,
    character: File,
    scans: Scans,
    stamps: Stamps,
    clock: Clock,
    read: Vec<u8>,
}

/// The number of a scan's time stamp among the channels.
const TIME: usize = usize::MAX;

/// From the bytes of a buffer to scans.
#[derive(Debug)]
struct Scans {
    layout: ScanLayout,
    /// The beginning of a scan whose end is not there yet.
    begun: Vec<u8>,
}

/// Where the times of scans come from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stamps {
    /// The kernel stamps each on `CLOCK_MONOTONIC`.
    Stamped,
    /// Nobody does: the time at which they are read, and so long between two.
    Arrival {
        /// From one scan to the next.
        period: Duration,
    },
}

impl Buffer {
    /// Sets up the buffer, starts it, and opens its character device.
    ///
    /// # Errors
    /// When the driver refuses a setting, or its files cannot be read.
    pub fn open(
        folder: Folder,
        channels: Channels,
        character: PathBuf,
        rate_hz: f64,
        clock: Clock,
    ) -> Result<Self, DeviceError> {
        // Nothing can be set while it runs, such as after a crash.
        folder.write("buffer/enable", "0")?;
        set_rate(&folder, rate_hz)?;
        let stamps = set_clock(&folder, rate_hz)?;
        let layout = set_elements(&folder, &channels, stamps)?;
        set_trigger(&folder)?;
        folder.write("buffer/length", KEPT_SCANS)?;
        folder.write("buffer/enable", "1")?;
        let opened = OpenOptions::new()
            .read(true)
            .custom_flags(libc::O_NONBLOCK)
            .open(&character);
        let file = opened.map_err(|source| DeviceError::Open {
            device: character.display().to_string(),
            source,
        })?;
        Ok(Self {
            folder,
            channels,
            path: character,
            character: file,
            scans: Scans {
                layout,
                begun: Vec::new(),
            },
            stamps,
            clock,
            read: vec![0; READ_BYTES],
        })
    }

    fn failed(&self, doing: &'static str, source: io::Error) -> DeviceError {
        DeviceError::Io {
            device: self.path.display().to_string(),
            doing,
            source,
        }
    }

    /// Waits for scans; whether there are any.
    fn wait(&self) -> Result<bool, DeviceError> {
        let mut waited = [PollFd::new(self.character.as_fd(), PollFlags::POLLIN)];
        let wait = PollTimeout::try_from(WAIT).unwrap_or(PollTimeout::ZERO);
        match poll(&mut waited, wait) {
            Ok(0) | Err(Errno::EINTR) => Ok(false),
            Ok(_) => Ok(true),
            Err(errno) => Err(self.failed("waiting", errno.into())),
        }
    }

    /// The mean of the scans in so many bytes that were read.
    fn decoded(&mut self, bytes: usize) -> Result<Option<Sample<RawValues>>, DeviceError> {
        let now = self.clock.now();
        let read = self.read.get(..bytes).unwrap_or_default();
        let mut all = self.scans.completed(read, &self.channels);
        match self.stamps {
            Stamps::Stamped => {
                let is_wrong = |sample: &Sample<RawValues>| {
                    sample.taken > now || now.since(sample.taken) > LATEST
                };
                if all.iter().any(is_wrong) {
                    return Err(DeviceError::Malformed {
                        device: self.path.display().to_string(),
                        what: "its time stamps are not of the monotonic clock",
                    });
                }
            }
            Stamps::Arrival { period } => {
                for (before, sample) in (0..).zip(all.iter_mut().rev()) {
                    sample.taken = now - period * before;
                }
            }
        }
        let mean = all
            .into_iter()
            .reduce(|earlier, later| RawValues::merged(&earlier, &later).unwrap_or(later));
        Ok(mean)
    }
}

impl Source for Buffer {
    type Value = RawValues;

    fn read(&mut self) -> Result<Option<Sample<RawValues>>, DeviceError> {
        if !self.wait()? {
            return Ok(None);
        }
        match self.character.read(&mut self.read) {
            // The driver is gone.
            Ok(0) => Err(self.failed("reading", Errno::ENODEV.into())),
            Ok(bytes) => self.decoded(bytes),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
            Err(error) => Err(self.failed("reading", error)),
        }
    }
}

impl Drop for Buffer {
    /// Stops the buffer. A device that is gone cannot be stopped.
    fn drop(&mut self) {
        let _ = self.folder.write("buffer/enable", "0");
    }
}

impl Scans {
    /// The scans that are complete with these bytes; the rest is kept.
    fn completed(&mut self, read: &[u8], channels: &Channels) -> Vec<Sample<RawValues>> {
        self.begun.extend_from_slice(read);
        let bytes = self.layout.bytes();
        let mut all = Vec::new();
        let complete = self.begun.chunks_exact(bytes);
        let rest = complete.remainder().to_vec();
        for scan in complete {
            let mut numbers = vec![0.0; channels.list.len()];
            let mut taken = Time::NEVER;
            for element in self.layout.elements() {
                let Some(number) = element.decode(scan) else {
                    continue;
                };
                if element.channel == TIME {
                    taken = Time::from_nanos(number);
                } else if let Some(place) = numbers.get_mut(element.channel) {
                    *place = number as f64;
                }
            }
            all.push(Sample::new(taken, channels.values(&numbers)));
        }
        self.begun = rest;
        all
    }
}

/// Sets how often the chip samples, if the driver lets one choose.
fn set_rate(folder: &Folder, rate_hz: f64) -> Result<(), DeviceError> {
    let files = [
        "sampling_frequency",
        "in_accel_sampling_frequency",
        "in_anglvel_sampling_frequency",
        "in_magn_sampling_frequency",
        "in_pressure_sampling_frequency",
    ];
    for file in files.into_iter().filter(|file| folder.has(file)) {
        if let Err(refused) = folder.write(file, &rate_hz.to_string()) {
            let choices = folder.text(&format!("{file}_available"));
            return Err(match choices {
                Ok(choices) => DeviceError::Refused {
                    device: folder.shown(),
                    what: format!("it refuses rate_hz = {rate_hz}: choose one of {choices}"),
                },
                Err(_) => refused,
            });
        }
    }
    Ok(())
}

/// Lets the kernel stamp the scans on the loop's clock.
fn set_clock(folder: &Folder, rate_hz: f64) -> Result<Stamps, DeviceError> {
    if folder.has("scan_elements/in_timestamp_en") && folder.has("current_timestamp_clock") {
        folder.write("current_timestamp_clock", "monotonic")?;
        return Ok(Stamps::Stamped);
    }
    let period = Duration::try_from_secs_f64(1.0 / rate_hz).unwrap_or_default();
    Ok(Stamps::Arrival { period })
}

/// Switches on what is to be in a scan, and everything else off.
fn set_elements(
    folder: &Folder,
    channels: &Channels,
    stamps: Stamps,
) -> Result<ScanLayout, DeviceError> {
    let mut enabled = Vec::new();
    let mut wanted: Vec<(usize, &str)> = channels
        .list
        .iter()
        .map(|channel| channel.name.as_str())
        .enumerate()
        .collect();
    if stamps == Stamps::Stamped {
        wanted.push((TIME, "in_timestamp"));
    }
    for name in others(folder, &wanted) {
        folder.write(&format!("scan_elements/{name}"), "0")?;
    }
    for (channel, name) in wanted {
        let file = |what: &str| format!("scan_elements/{name}_{what}");
        folder.write(&file("en"), "1")?;
        let index = folder.number(&file("index"))?;
        let text = folder.text(&file("type"));
        let text = text.map_err(|source| folder.failed(&file("type"), "reading", source))?;
        let stored: ScanType = text.parse().map_err(|_| DeviceError::Refused {
            device: folder.shown(),
            what: format!(
                "{name} is stored as {text:?}, which cannot be read here: set buffered = false"
            ),
        })?;
        enabled.push((index as u32, channel, stored));
    }
    Ok(ScanLayout::new(enabled))
}

/// The switches of what is not wanted.
fn others(folder: &Folder, wanted: &[(usize, &str)]) -> Vec<String> {
    let is_wanted = |file: &str| {
        let name = file.strip_suffix("_en");
        name.is_none_or(|name| wanted.iter().any(|(_, wanted)| *wanted == name))
    };
    let mut files = folder.files("scan_elements");
    files.retain(|file| !is_wanted(file));
    files
}

/// Chooses the device's own trigger, if it needs one and none is chosen.
fn set_trigger(folder: &Folder) -> Result<(), DeviceError> {
    const CURRENT: &str = "trigger/current_trigger";
    if !folder.has(CURRENT) || folder.text(CURRENT).is_ok_and(|chosen| !chosen.is_empty()) {
        return Ok(());
    }
    let own = folder.own_trigger();
    let Some(own) = own else {
        return Err(DeviceError::Refused {
            device: folder.shown(),
            what: "it needs a trigger, and has none of its own: create one of the kernel's timers \
                   (iio-trig-hrtimer) and write its name to trigger/current_trigger, or set \
                   buffered = false"
                .to_owned(),
        });
    };
    folder.write(CURRENT, &own)
}
