//! A device without a buffer, read file by file.

use core::time::Duration;
use std::thread;
use std::time::Instant;

use super::{Channels, Folder};
use crate::{Clock, DeviceError, RawValues, Sample, Source, WAIT};

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

/// Waits from sample to sample, without drift.
#[derive(Debug)]
pub(crate) struct Pace {
    period: Duration,
    next: Instant,
}

impl Pace {
    pub(crate) fn new(rate_hz: f64) -> Self {
        Self {
            period: Duration::try_from_secs_f64(1.0 / rate_hz).unwrap_or(WAIT),
            next: Instant::now(),
        }
    }

    /// Waits for the next sample, but no longer than [`WAIT`]; whether it is due.
    pub(crate) fn wait(&mut self) -> bool {
        let now = Instant::now();
        let left = self.next.saturating_duration_since(now);
        if left > WAIT {
            thread::sleep(WAIT);
            return false;
        }
        thread::sleep(left);
        // After a delay the missed ones are left out.
        self.next = (self.next + self.period).max(now);
        true
    }
}
