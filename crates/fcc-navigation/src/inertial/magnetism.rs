//! The earth's magnetic field: the World Magnetic Model 2025 (NCEI and British
//! Geological Survey), and 2020 before it.

use core::ops::Range;

use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::Date;
use world_magnetic_model::uom::si::angle::radian;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;
use world_magnetic_model::uom::si::magnetic_flux_density::microtesla;

use super::GeodeticPosition;

/// The years of the models, with their fractions.
pub const MAGNETIC_MODEL_YEARS: Range<f64> = 2020.0..2030.0;
const DAYS_OF_A_YEAR: f64 = 365.0;
/// The altitudes of the model, m.
const ALTITUDES_M: (f64, f64) = (-1_000.0, 850_000.0);

/// The field at a place in a year with its fraction: north, east, down, µT.
/// `None` outside [`MAGNETIC_MODEL_YEARS`], and where there is no such place.
///
/// ```
/// use fcc_navigation::inertial::{GeodeticPosition, earth_field_ut};
///
/// // A test value of the model's report: 80° north, on the equator of longitudes.
/// let place = GeodeticPosition {
///     latitude_rad: 80.0_f64.to_radians(),
///     longitude_rad: 0.0,
///     altitude_m: 0.0,
/// };
/// let [north_ut, east_ut, down_ut] = earth_field_ut(place, 2025.0).unwrap();
/// assert!((north_ut - 6.5216).abs() < 1e-3);
/// assert!((east_ut - 0.1459).abs() < 1e-3);
/// assert!((down_ut - 54.7915).abs() < 1e-3);
/// ```
pub fn earth_field_ut(place: GeodeticPosition, year: f64) -> Option<[f64; 3]> {
    if !MAGNETIC_MODEL_YEARS.contains(&year) {
        return None;
    }
    let whole = libm::floor(year);
    let day = 1.0 + libm::floor((year - whole) * DAYS_OF_A_YEAR);
    let date = Date::from_ordinal_date(whole as i32, day as u16).ok()?;
    let altitude_m = place.altitude_m.clamp(ALTITUDES_M.0, ALTITUDES_M.1);
    let field = GeomagneticField::new(
        Length::new::<meter>(altitude_m as f32),
        Angle::new::<radian>(place.latitude_rad as f32),
        Angle::new::<radian>(place.longitude_rad as f32),
        date,
    );
    let field = field.ok()?;
    Some([field.x(), field.y(), field.z()].map(|part| f64::from(part.get::<microtesla>())))
}
