//! The airspeed filters of one flight.

use super::airspeed_filter::{AirframePrior, AirspeedFilter};
use super::force_sample::ForceSample;

/// The filters of one flight: one that follows the sensor, and two that began
/// as its copies and have run without it since.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilterBank {
    pub(super) believing: AirspeedFilter,
    /// Without the sensor for 20 to 40 s, and for up to 20 s.
    pub(super) older: AirspeedFilter,
    pub(super) younger: AirspeedFilter,
    pub(super) younger_s: f64,
    pub(super) learned_s: f64,
    /// Whether the copies still compare with the models as they began, those of a single
    /// sample.
    pub(super) is_first: bool,
    pub(super) thrust_is_known: bool,
}

impl FilterBank {
    pub(super) fn new(prior: AirframePrior, sensor_mps: f64, sample: &ForceSample) -> Self {
        let believing = AirspeedFilter::new(prior, sensor_mps, sample);
        Self {
            believing,
            older: believing,
            younger: believing,
            younger_s: 0.0,
            learned_s: 0.0,
            is_first: sample.thrust.is_some(),
            thrust_is_known: sample.thrust.is_some(),
        }
    }

    pub(super) const fn each(&mut self) -> [&mut AirspeedFilter; 3] {
        [&mut self.believing, &mut self.older, &mut self.younger]
    }

    /// Both copies begin anew.
    pub(super) const fn follow_sensor(&mut self) {
        self.older = self.believing.kept();
        self.younger = self.older;
        self.younger_s = 0.0;
    }
}
