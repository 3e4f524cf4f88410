//! The pilot's switch on a line.

use core::time::Duration;

use fcc_core::framework::Switch;

use super::{Debounce, LevelLine};
use crate::pace::Pace;
use crate::{Clock, DeviceError, Sample, Source};

/// How often the line is read: the loop knows the position from the age of the
/// latest sample, so an edge alone would not do.
const RATE_HZ: f64 = 200.0;

/// A line as a [`Source`] of the engage switch's position: on while it is active.
#[derive(Debug)]
pub struct GpioSwitch<L> {
    line: L,
    debounce: Debounce,
    pace: Pace,
    clock: Clock,
}

impl<L: LevelLine> GpioSwitch<L> {
    /// A switch whose contacts rest within `settles_in`.
    pub fn new(line: L, settles_in: Duration, clock: Clock) -> Self {
        Self {
            line,
            debounce: Debounce::new(settles_in),
            pace: Pace::new(RATE_HZ),
            clock,
        }
    }
}

impl<L: LevelLine> Source for GpioSwitch<L> {
    type Value = Switch;

    fn read(&mut self) -> Result<Option<Sample<Switch>>, DeviceError> {
        if !self.pace.wait() {
            return Ok(None);
        }
        let is_active = self.line.is_active()?;
        let now = self.clock.now();
        let position = self.debounce.take(now, is_active);
        Ok(position.map(|is_on| {
            let switch = if is_on { Switch::On } else { Switch::Off };
            Sample::new(now, switch)
        }))
    }
}
