//! The ground below the aircraft.

use fcc_core::flight::terrain::Terrain;

use crate::config::SimConfig;
use crate::local_earth::LocalEarth;

/// Terrain where it is known, and level ground elsewhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroundBelow {
    level_m: f64,
    terrain: Terrain<'static>,
    earth: LocalEarth,
}

impl GroundBelow {
    pub(crate) fn new(config: &SimConfig) -> Self {
        Self {
            level_m: config.ground_m,
            terrain: config.terrain,
            earth: LocalEarth::new(config.latitude_rad, config.longitude_rad),
        }
    }

    /// Its elevation so far north and east of the start, m above mean sea level.
    pub(crate) fn elevation_m(&self, north_m: f64, east_m: f64) -> f64 {
        if self.terrain.is_empty() {
            return self.level_m;
        }
        let place = self.earth.position(north_m, east_m, 0.0);
        let elevation_m = self
            .terrain
            .elevation_m(place.latitude_rad, place.longitude_rad);
        elevation_m.unwrap_or(self.level_m)
    }
}
