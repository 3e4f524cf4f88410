//! Several inertial units: the first that is not bad is used.

use super::{Method, RawNavigation};
use crate::flight::Measurements;
use crate::framework::Flags;

/// The readings of an inertial unit, by their places among the measurements.
const FORCE: Flags = Flags::bit(15);
const RATES: Flags = Flags::bit(16);

impl RawNavigation {
    /// Of a sensor's plausible readings those that may be used: gyroscopes that the magnetic
    /// field contradicts are left for those of the next sensor, with the accelerometers of
    /// the same unit, and so are those that repeat themselves.
    pub fn permitted(&self, sensor: u8, plausible: Flags) -> Flags {
        plausible
            .keeping(FORCE, !self.accelerometers.is_left(sensor))
            .keeping(RATES, !self.gyroscopes.is_left(sensor))
    }

    /// Follows which of them the readings of a tick are of, and whether these repeat
    /// themselves.
    pub(super) fn follow_units(
        &mut self,
        raw: &Measurements,
        repeats_force: bool,
        repeats_rates: bool,
    ) {
        let (force, rates) = (raw.raw_specific_force, raw.raw_body_rates);
        if !force.is_never()
            && self.accelerometers.use_of(force.source)
            && let Method::Kalman(navigation) = &mut self.method
        {
            navigation.change_accelerometers();
        }
        if !rates.is_never() && self.gyroscopes.use_of(rates.source) {
            self.gyroscope.change();
            if let Method::Kalman(navigation) = &mut self.method {
                navigation.change_gyroscopes();
            }
        }
        let is_bad = repeats_rates || self.doubts_gyroscopes();
        if is_bad {
            self.gyroscopes.leave();
        }
        let is_one_unit = force.source == rates.source;
        if repeats_force || (is_bad && is_one_unit) {
            self.accelerometers.leave();
        }
        if repeats_force && is_one_unit {
            self.gyroscopes.leave();
        }
    }
}
