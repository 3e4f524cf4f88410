//! What the measurements differed by from what was expected of them.

use crate::inertial::ObservationKind;
use fcc_core::framework::Time;

/// More than any step has: of each sensor one for each inertial sample.
const CAPACITY: usize = 24;

/// The difference of a measurement from what the filter expected, one that is
/// consistent is within two of its standard deviations 95 times of 100.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Innovation {
    /// When the measurement was taken.
    pub time: Time,
    /// Of which sensor.
    pub kind: ObservationKind,
    /// In the sensor's unit (a position in m, pressures as altitude in m and
    /// airspeed in m/s): north, east, down, or body axes for a magnetic field.
    /// What is a number is the first, and the others are 0.
    pub difference: [f64; 3],
    /// The standard deviation that the filter expects of it.
    pub sigma: [f64; 3],
    /// Whether the filter used it.
    pub accepted: bool,
}

/// Those of one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Innovations {
    items: [Innovation; CAPACITY],
    length: usize,
}

const NONE: Innovation = Innovation {
    time: Time::NEVER,
    kind: ObservationKind::Rates,
    difference: [0.0; 3],
    sigma: [0.0; 3],
    accepted: false,
};

impl Default for Innovations {
    fn default() -> Self {
        Self {
            items: [NONE; CAPACITY],
            length: 0,
        }
    }
}

impl Innovations {
    pub(super) fn clear(&mut self) {
        self.length = 0;
    }

    pub(super) fn push(&mut self, innovation: Innovation) {
        if let Some(place) = self.items.get_mut(self.length) {
            *place = innovation;
            self.length += 1;
        }
    }

    pub(super) fn as_slice(&self) -> &[Innovation] {
        self.items.get(..self.length).unwrap_or_default()
    }
}
