//! A device without a buffer, read file by file.

use super::{Channels, Folder};
use crate::pace::Pace;
use crate::{Clock, DeviceError, RawValues, Sample, Source};

/// A device whose values are read one by one. Each read of a file makes the
/// driver ask the chip, which takes about 0.3 ms on I²C.
#[derive(Debug)]
pub struct Polled {
    folder: Folder,
    channels: Channels,
    files: Vec<String>,
    pace: Pace,
    clock: Clock,
}

impl Polled {
    /// Reads a device so often.
    ///
    /// # Errors
    /// When the first values cannot be read.
    pub fn new(
        folder: Folder,
        channels: Channels,
        rate_hz: f64,
        clock: Clock,
    ) -> Result<Self, DeviceError> {
        let files = channels.list.iter().map(|channel| {
            let kind = if channel.is_processed { "input" } else { "raw" };
            format!("{}_{kind}", channel.name)
        });
        let polled = Self {
            files: files.collect(),
            folder,
            channels,
            pace: Pace::new(rate_hz),
            clock,
        };
        polled.sample()?;
        Ok(polled)
    }

    fn sample(&self) -> Result<Sample<RawValues>, DeviceError> {
        let before = self.clock.now();
        let mut numbers = Vec::with_capacity(self.files.len());
        for file in &self.files {
            numbers.push(self.folder.number(file)?);
        }
        // The files were read one after the other.
        let half = self.clock.now().since(before) / 2;
        Ok(Sample::new(before + half, self.channels.values(&numbers)))
    }
}

impl Source for Polled {
    type Value = RawValues;

    fn read(&mut self) -> Result<Option<Sample<RawValues>>, DeviceError> {
        if !self.pace.wait() {
            return Ok(None);
        }
        self.sample().map(Some)
    }
}
