//! A chip that is asked again and again.

use core::time::Duration;
use std::fs::File;

use crate::device_clock::DeviceClock;
use crate::pace::Pace;
use crate::{Clock, DeviceError, RawValues, Sample, Source};

/// What a chip measured.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Measurement {
    /// The values; the mean, if there are several.
    pub values: RawValues,
    /// How long before the chip's answer it was measured.
    pub age: Duration,
    /// When, on the chip's own clock; none if it has none. That clock begins
    /// anywhere, and begins anew with the chip.
    pub stamp: Option<Duration>,
}

impl Measurement {
    /// Measured in the moment of the answer.
    pub const fn now(values: RawValues) -> Self {
        Self {
            values,
            age: Duration::ZERO,
            stamp: None,
        }
    }
}

/// A chip that is set up.
pub trait Chip {
    /// What it measured since it was asked last; `None` if there is nothing new.
    ///
    /// # Errors
    /// When it does not answer, or gives what is not valid.
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError>;
}

impl<C: Chip + ?Sized> Chip for Box<C> {
    fn measure(&mut self) -> Result<Option<Measurement>, DeviceError> {
        (**self).measure()
    }
}

/// A chip as a source of samples: asked so often, and stamped; where it stamps them
/// itself, by that.
#[derive(Debug)]
pub struct ChipSource<C> {
    chip: C,
    pace: Pace,
    clock: Clock,
    /// That no other daemon asks it.
    claim: Option<File>,
    device_clock: DeviceClock,
}

impl<C: Chip> ChipSource<C> {
    /// Asks a chip `rate_hz` times a second.
    pub fn new(chip: C, rate_hz: f64, clock: Clock) -> Self {
        Self {
            chip,
            pace: Pace::new(rate_hz),
            clock,
            claim: None,
            device_clock: DeviceClock::default(),
        }
    }

    /// Keeps the claim of its device for as long as it is asked.
    #[must_use]
    pub(crate) fn claimed(mut self, claim: File) -> Self {
        self.claim = Some(claim);
        self
    }
}

impl<C: Chip> Source for ChipSource<C> {
    type Value = RawValues;

    fn read(&mut self) -> Result<Option<Sample<RawValues>>, DeviceError> {
        if !self.pace.wait() {
            return Ok(None);
        }
        let measured = self.chip.measure()?;
        let answered = self.clock.now();
        Ok(measured.map(|measured| {
            let read = answered - measured.age;
            let taken = match measured.stamp {
                Some(stamp) => self.device_clock.time(stamp, read).min(answered),
                None => read,
            };
            Sample::new(taken, measured.values)
        }))
    }
}
