//! The airspeed of an aircraft that has no sensor of it.

use super::super::airframe::LearnedAirframe;
use super::super::filter_bank::FilterBank;
use super::super::force_sample::ForceSample;
use super::{AirspeedMonitor, LEAST_RATIO, MonitorInput};

/// Wind of which nothing is known, along the path, m/s.
pub(super) const UNKNOWN_WIND_MPS: f64 = 7.0;
/// The models count as learned after so long beside a sensor, s.
const LEARNED_S: f64 = 60.0;

impl AirspeedMonitor {
    /// Begins without a sensor: at the velocity over the ground, with a learned aircraft.
    pub(super) fn begin_by_forces(
        &self,
        input: &MonitorInput,
        sample: &ForceSample,
    ) -> Option<FilterBank> {
        let read = input.over_ground.filter(|_| {
            self.prior.learned.is_some() && input.motion_is_known && sample.models_hold()
        })?;
        let over_ground_mps = libm::hypot(read.north_mps, read.east_mps) * read.sqrt_density;
        let flies = over_ground_mps > LEAST_RATIO * self.prior.reference_mps;
        flies.then(|| {
            let found = (over_ground_mps, UNKNOWN_WIND_MPS);
            FilterBank::by_forces(self.prior, found, sample)
        })
    }

    /// What was learned of the aircraft beside a sensor that is believed, with a known
    /// throttle; none before a minute.
    pub(in super::super) fn learned(&self) -> Option<LearnedAirframe> {
        let bank = self.bank.as_ref().filter(|bank| {
            let is_taught = self.doubt.is_none() && !bank.is_by_forces && bank.thrust_is_known;
            is_taught && bank.learned_s > LEARNED_S
        })?;
        Some(bank.believing.learned())
    }
}
