//! The standard atmosphere below 11 km.
//!
//! International Standard Atmosphere (ISO 2533:1975): sea-level temperature
//! 288.15 K and pressure 101,325 Pa, lapse rate -6.5 K/km, dry air.

use libm::{pow, sqrt};

use crate::units::GRAVITY_MPS2;

/// The pressure at sea level, Pa: 1,013.25 hPa, 29.92126 inHg.
pub const SEA_LEVEL_PRESSURE_PA: f64 = 101_325.0;
const SEA_LEVEL_TEMPERATURE_K: f64 = 288.15;
const LAPSE_RATE_K_PER_M: f64 = -0.006_5;
const GAS_CONSTANT_J_PER_KG_K: f64 = 287.053;
/// The upper limit of the lapse rate, m. Higher altitudes are limited to this
/// one; the aircraft considered here do not reach it.
const TROPOPAUSE_M: f64 = 11_000.0;
/// The exponent of pressure over temperature, g/(-L R) = 5.256.
const PRESSURE_EXPONENT: f64 = GRAVITY_MPS2 / (-LAPSE_RATE_K_PER_M * GAS_CONSTANT_J_PER_KG_K);

/// Pressure altitude in m from static pressure in Pa (the thesis' figure 5.9: h
/// = (T₀/L)((p/p₀)^(-L R/g) - 1)). NaN for a pressure that is not positive.
///
/// ```
/// use fcc_core::flight::atmosphere::pressure_altitude_m;
/// // ISO 2533, table 5: 89,874.6 Pa at 1,000 m.
/// assert!((pressure_altitude_m(89_874.6) - 1_000.0).abs() < 0.1);
/// ```
pub fn pressure_altitude_m(pressure_pa: f64) -> f64 {
    let ratio = pow(pressure_pa / SEA_LEVEL_PRESSURE_PA, 1.0 / PRESSURE_EXPONENT);
    SEA_LEVEL_TEMPERATURE_K / LAPSE_RATE_K_PER_M * (ratio - 1.0)
}

/// Static pressure in Pa at a pressure altitude in m.
///
/// ```
/// use fcc_core::flight::atmosphere::pressure_pa;
/// // ISO 2533, table 5: 54,019.9 Pa at 5,000 m.
/// assert!((pressure_pa(5_000.0) - 54_019.9).abs() < 1.0);
/// ```
pub fn pressure_pa(altitude_m: f64) -> f64 {
    SEA_LEVEL_PRESSURE_PA * pow(temperature_ratio(altitude_m), PRESSURE_EXPONENT)
}

/// Air density over its sea-level value (1.225 kg/m³), σ, at a pressure
/// altitude in m.
///
/// ```
/// use fcc_core::flight::atmosphere::density_ratio;
/// // ISO 2533, table 5: 0.736116 kg/m³ at 5,000 m.
/// assert!((density_ratio(5_000.0) * 1.225 - 0.736_116).abs() < 1e-4);
/// ```
pub fn density_ratio(altitude_m: f64) -> f64 {
    pow(temperature_ratio(altitude_m), PRESSURE_EXPONENT - 1.0)
}

/// True airspeed in m/s from equivalent airspeed in m/s at a pressure altitude
/// in m: EAS/√σ. Below 100 m/s indicated, calibrated and equivalent airspeed
/// differ by less than 1 %.
///
/// ```
/// use fcc_core::flight::atmosphere::true_airspeed_mps;
/// // 200 kt true at 10,000 ft are 171.88 kt equivalent, as JSBSim has them.
/// let true_kt = true_airspeed_mps(171.88, 3_048.0);
/// assert!((true_kt - 200.0).abs() < 0.1);
/// ```
pub fn true_airspeed_mps(equivalent_mps: f64, altitude_m: f64) -> f64 {
    equivalent_mps / sqrt(density_ratio(altitude_m))
}

fn temperature_ratio(altitude_m: f64) -> f64 {
    1.0 + LAPSE_RATE_K_PER_M / SEA_LEVEL_TEMPERATURE_K * altitude_m.min(TROPOPAUSE_M)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ISO 2533:1975: geopotential altitude (m), pressure (Pa), density (kg/m³).
    const TABLE: [(f64, f64, f64); 5] = [
        (0.0, 101_325.0, 1.225),
        (1_000.0, 89_874.6, 1.111_64),
        (2_000.0, 79_495.2, 1.006_49),
        (5_000.0, 54_019.9, 0.736_116),
        (10_000.0, 26_436.3, 0.412_706),
    ];

    #[test]
    fn agrees_with_the_standard_atmosphere() {
        for (altitude, pressure, density) in TABLE {
            assert!((pressure_pa(altitude) / pressure - 1.0).abs() < 1e-5);
            assert!((density_ratio(altitude) * 1.225 / density - 1.0).abs() < 1e-5);
            assert!((pressure_altitude_m(pressure) - altitude).abs() < 0.1);
        }
    }

    /// FAA-H-8083-25C, chapter 4: pressure falls by about 1 inHg in 1,000 ft.
    #[test]
    fn an_inch_of_mercury_is_about_a_thousand_feet() {
        let feet = pressure_altitude_m(101_325.0 - 3_386.39) / 0.304_8;
        assert!((feet - 1_000.0).abs() < 100.0, "{feet}");
    }

    #[test]
    fn invalid_input_gives_nan() {
        assert!(pressure_altitude_m(-1.0).is_nan());
    }
}
