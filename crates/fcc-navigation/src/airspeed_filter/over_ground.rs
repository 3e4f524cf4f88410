//! The airspeed by the velocity over the ground and the wind.

use super::super::scalar_update::{squared, update};
use super::super::wind::{CORRELATED_S, OverGround};
use super::AirspeedFilter;

impl AirspeedFilter {
    /// Corrects by a reading, `dt_s` after the last: no sensor is used.
    pub(in super::super) fn correct_by_ground(&mut self, read: &OverGround, dt_s: f64) {
        if let Some((mps, sd_mps)) = self.by_ground_mps(read) {
            let by = mps - self.x[0];
            let per_reading = (2.0 * CORRELATED_S / dt_s).max(1.0);
            update(
                &mut self.x,
                &mut self.covariance,
                [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                by,
                per_reading * squared(sd_mps),
            );
        }
    }

    /// Indicated airspeed and its standard deviation, m/s.
    pub(in super::super) fn by_ground_mps(&self, read: &OverGround) -> Option<(f64, f64)> {
        let (mps, sd_mps) = self.wind.airspeed_mps(read)?;
        Some((mps * read.sqrt_density, sd_mps * read.sqrt_density))
    }
}
