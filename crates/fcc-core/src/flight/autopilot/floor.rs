//! The floor: an altitude below which no command and no mode leads.
//!
//! It limits the target altitude, so what is captured, commanded or part of a
//! pattern is flown down to the floor and held there; engaged below it, the
//! aircraft climbs to it. An aircraft without the power to hold its altitude
//! descends nevertheless: speed comes first.

use super::Autopilot;
use crate::flight::AltitudeReference;

impl Autopilot {
    /// Raises the target altitude to the floor.
    pub(super) fn keep_above_floor(&mut self) {
        // At sea level there is always a datum.
        let datum_m = self.altimeter.datum_m(AltitudeReference::SeaLevel);
        let floor_m = self.config.envelope.floor_m + datum_m.unwrap_or(0.0);
        self.is_at_floor = self.targets.altitude_m < floor_m;
        self.targets.altitude_m = self.targets.altitude_m.max(floor_m);
    }
}
