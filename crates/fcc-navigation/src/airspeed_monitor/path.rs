//! The climb rate by pitch and lift.

use super::super::force_sample::ForceSample;
use super::AirspeedMonitor;

impl AirspeedMonitor {
    /// The climb rate by pitch and lift, m/s, and the airspeed by forces and
    /// motion, indicated, m/s.
    pub(in super::super) fn path(&self, sample: &ForceSample) -> Option<(f64, f64)> {
        let bank = self.bank.as_ref().filter(|_| sample.models_hold())?;
        let filter = &bank.older;
        Some((filter.climb_rate_mps(sample), filter.airspeed_mps()))
    }
}
