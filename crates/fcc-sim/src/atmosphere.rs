//! The standard atmosphere, and the indication of an airspeed indicator.
//!
//! ISO 2533:1975, the same up to 32 km as the U.S. Standard Atmosphere 1976: a
//! temperature gradient in the troposphere, constant temperature in the lower
//! stratosphere. The earth is flat here, so geometric and geopotential altitude
//! are equal, and so are altitude and pressure altitude.

use libm::{exp, pow, sqrt};

use crate::units::STANDARD_GRAVITY_MPS2;

/// Pressure at sea level, Pa.
pub const SEA_LEVEL_PRESSURE_PA: f64 = 101_325.0;
/// Temperature at sea level, K.
pub const SEA_LEVEL_TEMPERATURE_K: f64 = 288.15;
/// Density at sea level, kg/m³.
pub const SEA_LEVEL_DENSITY_KGPM3: f64 =
    SEA_LEVEL_PRESSURE_PA / (GAS_CONSTANT * SEA_LEVEL_TEMPERATURE_K);

/// Specific gas constant of air, J/(kg·K).
const GAS_CONSTANT: f64 = 287.052_87;
/// Ratio of the specific heats of air.
const HEAT_RATIO: f64 = 1.4;
/// Temperature gradient in the troposphere, K/m.
const LAPSE_KPM: f64 = 0.0065;
/// The upper limit of the troposphere, m.
const TROPOPAUSE_M: f64 = 11_000.0;
/// Temperature of the lower stratosphere, K.
const STRATOSPHERE_K: f64 = SEA_LEVEL_TEMPERATURE_K - LAPSE_KPM * TROPOPAUSE_M;
/// Exponent of pressure over temperature in the troposphere.
const PRESSURE_EXPONENT: f64 = STANDARD_GRAVITY_MPS2 / (GAS_CONSTANT * LAPSE_KPM);
/// The upper limit of the model, m: in the next layer temperature rises.
const CEILING_M: f64 = 20_000.0;
/// The lower limit of the model, m, below the lowest land: keeps the formulas
/// valid if an aircraft falls further.
const FLOOR_M: f64 = -5_000.0;

/// The air at one altitude.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Air {
    /// Static pressure, Pa.
    pub pressure_pa: f64,
    /// Temperature, K.
    pub temperature_k: f64,
    /// Density, kg/m³.
    pub density_kgpm3: f64,
}

impl Air {
    /// The standard air at an altitude in m above mean sea level. Outside
    /// -5..20 km it is that of the nearer limit.
    pub fn at(altitude_m: f64) -> Self {
        let altitude_m = altitude_m.clamp(FLOOR_M, CEILING_M);
        let (temperature_k, pressure_pa) = if altitude_m <= TROPOPAUSE_M {
            troposphere(altitude_m)
        } else {
            let (_, tropopause_pa) = troposphere(TROPOPAUSE_M);
            let scale_height_m = GAS_CONSTANT * STRATOSPHERE_K / STANDARD_GRAVITY_MPS2;
            let fall = exp(-(altitude_m - TROPOPAUSE_M) / scale_height_m);
            (STRATOSPHERE_K, tropopause_pa * fall)
        };
        Self {
            pressure_pa,
            temperature_k,
            density_kgpm3: pressure_pa / (GAS_CONSTANT * temperature_k),
        }
    }

    /// Density relative to sea level.
    pub fn density_ratio(&self) -> f64 {
        self.density_kgpm3 / SEA_LEVEL_DENSITY_KGPM3
    }

    /// Speed of sound, m/s.
    pub fn sound_mps(&self) -> f64 {
        sqrt(HEAT_RATIO * GAS_CONSTANT * self.temperature_k)
    }

    /// Equivalent airspeed of a true airspeed, both m/s: the speed of the same
    /// dynamic pressure at sea level.
    pub fn equivalent_mps(&self, true_mps: f64) -> f64 {
        true_mps * sqrt(self.density_ratio())
    }

    /// The indication of an airspeed indicator without position error at a true
    /// airspeed, both m/s: calibrated airspeed, from the impact pressure of
    /// subsonic compressible flow.
    pub fn indicated_mps(&self, true_mps: f64) -> f64 {
        let impact_pa = impact_pressure(true_mps / self.sound_mps(), self.pressure_pa);
        let mach = mach_of_impact(impact_pa, SEA_LEVEL_PRESSURE_PA);
        mach * sqrt(HEAT_RATIO * GAS_CONSTANT * SEA_LEVEL_TEMPERATURE_K)
    }

    /// The true airspeed for an indicated airspeed, both m/s.
    pub fn true_of_indicated_mps(&self, indicated_mps: f64) -> f64 {
        let sea_level_sound = sqrt(HEAT_RATIO * GAS_CONSTANT * SEA_LEVEL_TEMPERATURE_K);
        let impact_pa = impact_pressure(indicated_mps / sea_level_sound, SEA_LEVEL_PRESSURE_PA);
        mach_of_impact(impact_pa, self.pressure_pa) * self.sound_mps()
    }
}

/// Temperature in K and pressure in Pa in the troposphere.
fn troposphere(altitude_m: f64) -> (f64, f64) {
    let temperature_k = SEA_LEVEL_TEMPERATURE_K - LAPSE_KPM * altitude_m;
    let ratio = temperature_k / SEA_LEVEL_TEMPERATURE_K;
    (
        temperature_k,
        SEA_LEVEL_PRESSURE_PA * pow(ratio, PRESSURE_EXPONENT),
    )
}

/// Pressure rise at a pitot tube, Pa, isentropic (γ = 1.4).
fn impact_pressure(mach: f64, static_pa: f64) -> f64 {
    let rise = 1.0 + 0.2 * mach * mach;
    // rise^3.5 by a square root: faster than a power, and as accurate.
    static_pa * (rise * rise * rise * sqrt(rise) - 1.0)
}

/// The inverse of [`impact_pressure`].
fn mach_of_impact(impact_pa: f64, static_pa: f64) -> f64 {
    sqrt((5.0 * (pow(impact_pa / static_pa + 1.0, 2.0 / 7.0) - 1.0)).max(0.0))
}
