//! The earth near a place.

use fcc_core::flight::Position;
use libm::{cos, sin, sqrt};

use crate::truth::half_turn;

/// The flat earth, tangent to the WGS 84 ellipsoid where the flight begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalEarth {
    latitude_rad: f64,
    longitude_rad: f64,
    north_radius_m: f64,
    /// Of the circle of latitude.
    east_radius_m: f64,
}

impl LocalEarth {
    pub(crate) fn new(latitude_rad: f64, longitude_rad: f64) -> Self {
        /// WGS 84: semi-major axis, m, and first eccentricity squared.
        const EQUATOR_M: f64 = 6_378_137.0;
        const ECCENTRICITY_2: f64 = 6.694_379_990_14e-3;
        let sine = sin(latitude_rad);
        let shape = 1.0 - ECCENTRICITY_2 * sine * sine;
        Self {
            latitude_rad,
            longitude_rad,
            north_radius_m: EQUATOR_M * (1.0 - ECCENTRICITY_2) / (shape * sqrt(shape)),
            east_radius_m: EQUATOR_M / sqrt(shape) * cos(latitude_rad),
        }
    }

    /// North and east of the origin, m; east by the shorter way.
    pub(crate) fn north_east_m(&self, position: &Position) -> (f64, f64) {
        let east_rad = half_turn(position.longitude_rad - self.longitude_rad);
        (
            (position.latitude_rad - self.latitude_rad) * self.north_radius_m,
            east_rad * self.east_radius_m,
        )
    }

    pub(crate) fn position(&self, north_m: f64, east_m: f64, altitude_m: f64) -> Position {
        Position {
            latitude_rad: self.latitude_rad + north_m / self.north_radius_m,
            longitude_rad: half_turn(self.longitude_rad + east_m / self.east_radius_m),
            altitude_m,
        }
    }
}
