//! The earth's magnetic field: the World Magnetic Model 2025 (NCEI and British
//! Geological Survey), and 2020 before it.

use std::time::{SystemTime, UNIX_EPOCH};

use fcc_core::flight::inertial::GeodeticPosition;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::Date;
use world_magnetic_model::uom::si::angle::radian;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;
use world_magnetic_model::uom::si::magnetic_flux_density::microtesla;

/// The years of the models.
const YEARS: (f64, f64) = (2020.0, 2030.0);
/// In the last days of the model's time.
const LAST: f64 = 2029.99;
const DAYS_OF_A_YEAR: f64 = 365.0;
const SECONDS_OF_A_YEAR: f64 = 365.242_5 * 86_400.0;
/// The altitudes of the model, m.
const ALTITUDES_M: (f64, f64) = (-1_000.0, 850_000.0);

/// A year with its fraction that the models are of.
pub(super) fn check(year: Option<f64>) -> PyResult<()> {
    match year {
        Some(year) if !(YEARS.0..YEARS.1).contains(&year) => Err(PyValueError::new_err(format!(
            "year is {year}: the World Magnetic Model is of 2020 to 2029.999; give the nearest, \
             a declination changes by 0.1 to 0.2° a year"
        ))),
        _ => Ok(()),
    }
}

/// North, east, down, µT; now, if no year is given.
pub(super) fn earth_field_ut(place: GeodeticPosition, year: Option<f64>) -> PyResult<[f64; 3]> {
    check(year)?;
    let year = year.unwrap_or_else(|| now().clamp(YEARS.0, LAST));
    let day = 1.0 + (year.fract() * DAYS_OF_A_YEAR).floor();
    let no_field = |error: &dyn std::fmt::Display| {
        PyValueError::new_err(format!(
            "gnss_position: no magnetic field at latitude {} rad, longitude {} rad: {error}",
            place.latitude_rad, place.longitude_rad
        ))
    };
    let date =
        Date::from_ordinal_date(year as i32, day as u16).map_err(|error| no_field(&error))?;
    let altitude_m = place.altitude_m.clamp(ALTITUDES_M.0, ALTITUDES_M.1);
    let field = GeomagneticField::new(
        Length::new::<meter>(altitude_m as f32),
        Angle::new::<radian>(place.latitude_rad as f32),
        Angle::new::<radian>(place.longitude_rad as f32),
        date,
    )
    .map_err(|error| no_field(&error))?;
    Ok([field.x(), field.y(), field.z()].map(|part| f64::from(part.get::<microtesla>())))
}

fn now() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    1970.0 + since.map_or(0.0, |since| since.as_secs_f64()) / SECONDS_OF_A_YEAR
}
