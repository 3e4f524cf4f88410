//! The earth's magnetic field where a flight begins.

use std::time::{SystemTime, UNIX_EPOCH};

use fcc_navigation::inertial::{self, GeodeticPosition, MAGNETIC_MODEL_YEARS};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// In the last days of the model's time.
const LAST: f64 = 2029.99;
const SECONDS_OF_A_YEAR: f64 = 365.242_5 * 86_400.0;

/// A year with its fraction that the models are of.
pub(super) fn check(year: Option<f64>) -> PyResult<()> {
    match year {
        Some(year) if !MAGNETIC_MODEL_YEARS.contains(&year) => Err(PyValueError::new_err(format!(
            "year is {year}: the World Magnetic Model is of 2020 to 2029.999; give the \
                 nearest, a declination changes by 0.1 to 0.2° a year"
        ))),
        _ => Ok(()),
    }
}

/// North, east, down, µT; now, if no year is given.
pub(super) fn earth_field_ut(place: GeodeticPosition, year: Option<f64>) -> PyResult<[f64; 3]> {
    check(year)?;
    let year = year.unwrap_or_else(|| now().clamp(MAGNETIC_MODEL_YEARS.start, LAST));
    inertial::earth_field_ut(place, year).ok_or_else(|| {
        PyValueError::new_err(format!(
            "gnss_position: no magnetic field at latitude {} rad, longitude {} rad: give -π/2 to \
             π/2, and -π to π",
            place.latitude_rad, place.longitude_rad
        ))
    })
}

fn now() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    1970.0 + since.map_or(0.0, |since| since.as_secs_f64()) / SECONDS_OF_A_YEAR
}
