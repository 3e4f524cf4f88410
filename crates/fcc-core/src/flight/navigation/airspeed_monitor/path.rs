//! The climb rate by pitch and lift.

use super::super::airspeed_filter::AirspeedFilter;
use super::super::force_sample::ForceSample;
use super::AirspeedMonitor;

impl AirspeedMonitor {
    /// The climb rate by pitch and lift, m/s, and the airspeed by forces and
    /// motion, indicated, m/s.
    pub(in super::super) fn path(&self, sample: &ForceSample) -> Option<(f64, f64)> {
        let filter = self.alone(sample)?;
        Some((filter.climb_rate_mps(sample), filter.airspeed_mps()))
    }

    /// That climb rate with the models of 20 to 40 s ago, m/s: an altimeter that has drifted
    /// since is not in them.
    pub(in super::super) fn kept_path_mps(&self, sample: &ForceSample) -> Option<f64> {
        let filter = self.alone(sample).filter(|filter| filter.is_copy())?;
        Some(filter.kept_climb_rate_mps(sample))
    }

    /// The filter that has run longest without the sensor, where its models hold.
    fn alone(&self, sample: &ForceSample) -> Option<&AirspeedFilter> {
        let bank = self.bank.as_ref().filter(|_| sample.models_hold())?;
        Some(&bank.older)
    }
}
