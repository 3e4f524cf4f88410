//! The standard atmosphere below 11 km.
//!
//! International Standard Atmosphere (ISO 2533:1975): sea-level temperature
//! 288.15 K and pressure 101,325 Pa, lapse rate -6.5 K/km, dry air.

use libm::{pow, sqrt};

use crate::units::GRAVITY_MPS2;

/// The pressure at sea level, Pa: 1,013.25 hPa, 29.92126 inHg.
pub const SEA_LEVEL_PRESSURE_PA: f64 = 101_325.0;
/// Temperature at mean sea level, K.
pub const SEA_LEVEL_TEMPERATURE_K: f64 = 288.15;
/// Density at sea level, kg/m³ (ISO 2533:1975).
pub const SEA_LEVEL_DENSITY_KGPM3: f64 = 1.225;
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

/// The ratio of the specific heats of air.
const HEAT_RATIO: f64 = 1.4;

/// Calibrated airspeed in m/s from total minus static pressure in Pa: the speed
/// of that impact pressure at sea level, in subsonic flow (ICAO Doc 7488). What
/// an indicator without error shows, and so the indicated airspeed of a pitot
/// tube whose position error is not known. 0 for a pressure that is not
/// positive.
///
/// ```
/// use fcc_core::flight::atmosphere::calibrated_airspeed_mps;
/// // At low speed √(2 q/ρ), 1.225 kg/m³: 612.5 Pa for 31.6 m/s.
/// assert!((calibrated_airspeed_mps(612.5) - 31.6).abs() < 0.1);
/// ```
pub fn calibrated_airspeed_mps(differential_pa: f64) -> f64 {
    mach(differential_pa, SEA_LEVEL_PRESSURE_PA) * speed_of_sound_mps(SEA_LEVEL_TEMPERATURE_K)
}

/// Total minus static pressure in Pa at a calibrated airspeed in m/s: the
/// inverse of [`calibrated_airspeed_mps`].
pub fn differential_pressure_pa(calibrated_mps: f64) -> f64 {
    let mach = calibrated_mps / speed_of_sound_mps(SEA_LEVEL_TEMPERATURE_K);
    SEA_LEVEL_PRESSURE_PA * (pow(1.0 + 0.2 * mach * mach, 3.5) - 1.0)
}

/// The Mach number from total minus static, and static pressure, both Pa:
/// isentropic, subsonic (NACA Report 1135, 1953, equation 44). 0 for a
/// differential pressure that is not positive.
pub fn mach(differential_pa: f64, static_pa: f64) -> f64 {
    sqrt(5.0 * (pow(differential_pa.max(0.0) / static_pa + 1.0, 2.0 / 7.0) - 1.0))
}

/// True airspeed in m/s from total minus static pressure and static pressure in
/// Pa, and the temperature of the undisturbed air in K.
///
/// ```
/// use fcc_core::flight::atmosphere::true_airspeed_from_pressures_mps;
/// // At sea level in the standard atmosphere it is the calibrated one.
/// let mps = true_airspeed_from_pressures_mps(1_632.0, 101_325.0, 288.15);
/// assert!((mps - 51.44).abs() < 0.05);
/// ```
pub fn true_airspeed_from_pressures_mps(
    differential_pa: f64,
    static_pa: f64,
    temperature_k: f64,
) -> f64 {
    mach(differential_pa, static_pa) * speed_of_sound_mps(temperature_k)
}

/// The speed of sound in m/s in air of a temperature in K.
fn speed_of_sound_mps(temperature_k: f64) -> f64 {
    sqrt(HEAT_RATIO * GAS_CONSTANT_J_PER_KG_K * temperature_k)
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

    /// NACA Report 1135 (1953), table I: static over total pressure by Mach
    /// number.
    const ISENTROPIC: [(f64, f64); 4] = [
        (0.1, 0.993_03),
        (0.3, 0.939_47),
        (0.5, 0.843_02),
        (0.8, 0.656_02),
    ];

    /// ISO 2533:1975: speed of sound 340.294 m/s at sea level, 320.545 m/s at
    /// 5,000 m geometric altitude, 255.676 K and 54,048.3 Pa.
    #[test]
    fn airspeeds_agree_with_the_tables_of_compressible_flow() {
        for (number, ratio) in ISENTROPIC {
            let at = |static_pa: f64| static_pa / ratio - static_pa;
            // Five digits of the table: at low speed its last one is 1e-3 of q.
            let within = 0.5e-5 / (1.0 - ratio);
            let calibrated = calibrated_airspeed_mps(at(101_325.0));
            assert!(
                (calibrated / (340.294 * number) - 1.0).abs() < within,
                "{number}"
            );
            let high = true_airspeed_from_pressures_mps(at(54_048.3), 54_048.3, 255.676);
            assert!((high / (320.545 * number) - 1.0).abs() < within, "{number}");
            let back = differential_pressure_pa(340.294 * number);
            assert!(
                (back / at(101_325.0) - 1.0).abs() < 2.0 * within,
                "{number}"
            );
        }
    }

    /// Blown from behind, or a zero that drifted.
    #[test]
    fn a_negative_differential_pressure_is_no_airspeed() {
        assert_eq!(calibrated_airspeed_mps(-3.0), 0.0);
        assert_eq!(mach(-3.0, 90_000.0), 0.0);
    }

    #[test]
    fn invalid_input_gives_nan() {
        assert!(pressure_altitude_m(-1.0).is_nan());
    }
}
