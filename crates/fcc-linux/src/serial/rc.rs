//! An RC receiver on a serial line.

use core::fmt;
use core::time::Duration;
use std::path::PathBuf;

use fcc_core::framework::Time;
use serde::{Deserialize, Serialize};

use super::{
    Crsf, Frames, LineSettings, Pilot, RcChannels, RcValues, ReceiverFrame, Sbus, SerialLine,
};
use crate::{DeviceError, Sample, Source};

/// The silence between two frames of SBUS is at least 4 ms; within one a driver
/// hands on what it has at least every 2 ms.
const SBUS_GAP: Duration = Duration::from_millis(3);
/// With less than one frame in so many bytes they are not understood: 2 s of SBUS.
const NOTHING_UNDERSTOOD: usize = 7_000;

/// What a receiver speaks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RcProtocol {
    /// [`Sbus`]: a line that cannot invert needs an inverter.
    Sbus,
    /// [`Crsf`].
    Crsf,
}

impl RcProtocol {
    /// How a line is set for it.
    pub fn line(self, path: impl Into<PathBuf>) -> LineSettings {
        let (baud, has_even_parity) = match self {
            Self::Sbus => (100_000, true),
            Self::Crsf => (420_000, false),
        };
        LineSettings {
            path: path.into(),
            baud,
            has_even_parity,
        }
    }
}

enum Reader {
    Sbus(Frames<Sbus>),
    Crsf(Frames<Crsf>),
}

impl Reader {
    fn push(&mut self, bytes: &[u8], each: impl FnMut(ReceiverFrame)) {
        match self {
            Self::Sbus(frames) => frames.push(bytes, each),
            Self::Crsf(frames) => frames.push(bytes, each),
        }
    }

    const fn damaged(&self) -> u64 {
        match self {
            Self::Sbus(frames) => frames.damaged(),
            Self::Crsf(frames) => frames.damaged(),
        }
    }
}

/// An open receiver: a [`Source`] of the pilot's switch and sticks.
pub struct RcReceiver {
    line: SerialLine,
    clock: Box<dyn Fn() -> Time + Send>,
    reader: Reader,
    received: Time,
    pilot: Pilot,
    not_understood: usize,
}

impl fmt::Debug for RcReceiver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RcReceiver")
            .field("line", &self.line)
            .field("pilot", &self.pilot)
            .finish_non_exhaustive()
    }
}

impl RcReceiver {
    /// Opens the line, set for the protocol ([`RcProtocol::line`]); `clock` is the
    /// loop's, [`monotonic`](crate::monotonic).
    ///
    /// # Errors
    /// See [`SerialLine::open`].
    pub fn open(
        line: &LineSettings,
        protocol: RcProtocol,
        channels: RcChannels,
        clock: impl Fn() -> Time + Send + 'static,
    ) -> Result<Self, DeviceError> {
        Ok(Self {
            line: SerialLine::open(line)?,
            clock: Box::new(clock),
            reader: match protocol {
                RcProtocol::Sbus => Reader::Sbus(Frames::default()),
                RcProtocol::Crsf => Reader::Crsf(Frames::default()),
            },
            received: Time::NEVER,
            pilot: Pilot::new(channels),
            not_understood: 0,
        })
    }

    fn malformed(&self, what: &'static str) -> DeviceError {
        DeviceError::Malformed {
            device: self.line.path().display().to_string(),
            what,
        }
    }
}

impl Source for RcReceiver {
    type Value = RcValues;

    fn read(&mut self) -> Result<Option<Sample<RcValues>>, DeviceError> {
        let mut buffer = [0; 256];
        let length = self.line.read(&mut buffer)?;
        if length == 0 {
            return Ok(None);
        }
        let now = (self.clock)();
        if let Reader::Sbus(frames) = &mut self.reader
            && now.since(self.received) >= SBUS_GAP
        {
            frames.restart();
        }
        self.received = now;
        let damaged = self.reader.damaged();
        let (mut frames, mut values) = (0, None);
        let pilot = &mut self.pilot;
        self.reader
            .push(buffer.get(..length).unwrap_or_default(), |frame| {
                frames += 1;
                values = pilot.take(&frame).or(values);
            });
        if let Some(values) = values {
            self.not_understood = 0;
            return Ok(Some(Sample::new(now, values)));
        }
        self.not_understood = match frames {
            0 => self.not_understood + length,
            _ => 0,
        };
        if self.not_understood > NOTHING_UNDERSTOOD {
            self.not_understood = 0;
            return Err(self.malformed(
                "bytes arrive, but no frame that is known: check `protocol`; SBUS is inverted, \
                 and needs an inverter at most lines",
            ));
        }
        if self.reader.damaged() > damaged {
            return Err(self.malformed("a frame arrived damaged: check the line and its length"));
        }
        Ok(None)
    }
}
