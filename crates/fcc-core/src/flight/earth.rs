//! The shape and the gravity of the earth: WGS-84 (NIMA TR8350.2, 3rd ed.,
//! 2000, tables 3.1 and 3.4, equations 4-1 and 4-3).

use libm::{cos, sin, sqrt};

use crate::units::GRAVITY_MPS2;

/// The semi-major axis, m.
pub const SEMI_MAJOR_AXIS_M: f64 = 6_378_137.0;
/// The square of the first eccentricity.
pub const ECCENTRICITY_2: f64 = 6.694_379_990_14e-3;
/// Normal gravity at the equator, m/s², and the constant of Somigliana's
/// formula.
const EQUATORIAL_GRAVITY_MPS2: f64 = 9.780_325_335_9;
const SOMIGLIANA: f64 = 1.931_852_652_41e-3;
/// The relative change of gravity with altitude, 1/m: -2/a (1 + f + m) at the
/// mean latitude, to 0.1 % up to 20 km.
const GRAVITY_PER_M: f64 = -3.14e-7;
/// The longest degree of longitude is compared with this share of it, at 89.9°:
/// nearer to a pole a longitude says nothing.
const LEAST_COSINE: f64 = 1.745e-3;

/// The lengths in m of one radian of latitude and of longitude, at a geodetic
/// latitude in rad and an altitude in m: M + h and (N + h) cos φ.
///
/// ```
/// use fcc_core::flight::earth::metres_per_radian;
/// // A degree of latitude at 45° is 111,132 m, one of longitude 78,847 m
/// // (NGA, Length of a Degree of Latitude and Longitude Calculator).
/// let (north, east) = metres_per_radian(45.0_f64.to_radians(), 0.0);
/// assert!((north.to_radians() - 111_132.0).abs() < 1.0);
/// assert!((east.to_radians() - 78_847.0).abs() < 1.0);
/// ```
pub fn metres_per_radian(latitude_rad: f64, altitude_m: f64) -> (f64, f64) {
    let sine = sin(latitude_rad);
    let w2 = 1.0 - ECCENTRICITY_2 * sine * sine;
    let prime_vertical = SEMI_MAJOR_AXIS_M / sqrt(w2);
    let meridian = prime_vertical * (1.0 - ECCENTRICITY_2) / w2;
    (
        meridian + altitude_m,
        (prime_vertical + altitude_m) * cos(latitude_rad).max(LEAST_COSINE),
    )
}

/// Gravity in m/s² at a geodetic latitude in rad and an altitude in m;
/// standard gravity where the latitude is not known (NaN).
///
/// ```
/// use fcc_core::flight::earth::gravity_mps2;
/// // WGS-84: 9.7803 m/s² at the equator, 9.8322 m/s² at the poles.
/// assert!((gravity_mps2(0.0, 0.0) - 9.780_325).abs() < 1e-6);
/// assert!((gravity_mps2(90.0_f64.to_radians(), 0.0) - 9.832_185).abs() < 1e-6);
/// ```
pub fn gravity_mps2(latitude_rad: f64, altitude_m: f64) -> f64 {
    if latitude_rad.is_nan() {
        return GRAVITY_MPS2;
    }
    let sine_2 = sin(latitude_rad) * sin(latitude_rad);
    let at_sea_level =
        EQUATORIAL_GRAVITY_MPS2 * (1.0 + SOMIGLIANA * sine_2) / sqrt(1.0 - ECCENTRICITY_2 * sine_2);
    at_sea_level * (1.0 + GRAVITY_PER_M * altitude_m)
}
