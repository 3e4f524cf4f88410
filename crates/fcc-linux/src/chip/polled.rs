//! A chip that is asked again and again.

use core::time::Duration;
use std::fs::File;

use crate::pace::Pace;
use crate::{Clock, DeviceError, RawValues, Sample, Source};

/// What a chip measured.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Measurement {
    /// The values; the mean, if there are several.
    pub values: RawValues,
    /// How long before the chip's answer it was measured.
    pub age: Duration,
}

impl Measurement {
    /// Measured in the moment of the answer.
    pub const fn now(values: RawValues) -> Self {
        Self {
            values,
            age: Duration::ZERO,
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

/// A chip as a source of samples: asked so often, and stamped.
#[derive(Debug)]
pub struct ChipSource<C> {
    chip: C,
    pace: Pace,
    clock: Clock,
    /// That no other daemon asks it.
    claim: Option<File>,
}

impl<C: Chip> ChipSource<C> {
    /// Asks a chip `rate_hz` times a second.
    pub fn new(chip: C, rate_hz: f64, clock: Clock) -> Self {
        Self {
            chip,
            pace: Pace::new(rate_hz),
            clock,
            claim: None,
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
        Ok(measured.map(|measured| Sample::new(answered - measured.age, measured.values)))
    }
}
