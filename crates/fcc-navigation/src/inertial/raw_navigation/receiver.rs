//! Fixes of a satellite receiver.

use super::super::{Observation, earth_field_ut};
use super::readings::{place_in, velocity_in};
use super::{MagneticNorth, RawNavigation, declination_rad};
use fcc_core::flight::GnssFix;
use fcc_core::framework::Time;

impl RawNavigation {
    /// Takes a fix, without a velocity that is only repeated; at the first one, the magnetic
    /// field of the place.
    pub(super) fn take_fix(&mut self, taken: Time, fix: &GnssFix) {
        let place = place_in(fix);
        if let MagneticNorth::ModelOf(year) = self.config.north
            && !self.knows_field
            && let Some(field) = earth_field_ut(place, year)
        {
            self.filter.learn_earth_field(field);
            self.sensors.learn_earth_field(field);
            self.declination_rad = declination_rad(field);
            // Where else it flies, the filter follows the field by itself.
            self.knows_field = true;
        }
        self.take(taken, Observation::Position(place));
        if !self.repeats.is_same_velocity {
            let mut velocity = velocity_in(fix);
            let witness = &mut self.gyroscope.witness;
            witness.add_velocity(taken, velocity, &self.solution);
            if self.repeats.is_down_old() {
                velocity[2] = f64::NAN;
            }
            self.take(taken, Observation::Velocity(velocity));
        }
    }
}
