//! The airspeed filters of one flight.

use super::airframe::AirframePrior;
use super::airspeed_filter::AirspeedFilter;
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
    /// There has been no sensor: the copies know the forces alone, and the one that would
    /// follow it what the velocity over the ground and the wind say beside them.
    pub(super) is_by_forces: bool,
}

/// The error of an airspeed by forces that lasts, over that airspeed: one standard
/// deviation.
const FORCES_ERROR: f64 = 0.1;
/// Standard deviation of an airspeed sensor's first reading, m/s.
const SENSOR_SD_MPS: f64 = 1.0;

impl FilterBank {
    pub(super) fn new(prior: AirframePrior, sensor_mps: f64, sample: &ForceSample) -> Self {
        let believing = AirspeedFilter::new(prior, (sensor_mps, SENSOR_SD_MPS), sample);
        Self {
            believing,
            older: believing,
            younger: believing,
            younger_s: 0.0,
            learned_s: 0.0,
            is_first: sample.thrust.is_some(),
            thrust_is_known: sample.thrust.is_some(),
            is_by_forces: false,
        }
    }

    /// Without a sensor: it begins at an airspeed with this standard deviation, m/s.
    pub(super) fn by_forces(prior: AirframePrior, found: (f64, f64), sample: &ForceSample) -> Self {
        let mut believing = AirspeedFilter::new(prior, found, sample).kept();
        believing.wind.expect_error(FORCES_ERROR);
        Self {
            believing,
            older: believing,
            younger: believing,
            younger_s: 0.0,
            learned_s: 0.0,
            is_first: false,
            thrust_is_known: sample.thrust.is_some(),
            is_by_forces: true,
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
