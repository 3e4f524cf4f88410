//! The altimeter: what an altitude refers to, and its pressure altitude.
//!
//! A barometer measures pressure altitude: the altitude in the standard
//! atmosphere at which the pressure is the measured one. What an altimeter
//! indicates is less by the pressure altitude of its setting (Smithsonian
//! Meteorological Tables, 6th ed. 1951, table 65; ARINC 706 calls it
//! baro-corrected altitude), so a change of the setting shifts every indicated
//! altitude by the same amount.

use core::ops::RangeInclusive;

use super::atmosphere::pressure_altitude_m;
use crate::schema;

/// The altimeter settings that are accepted, Pa: 27.76 to 31.30 inHg. The scales
/// of many altimeters end at 31.00 inHg (FAA, Aeronautical Information Manual,
/// 7-2-3).
pub const ALTIMETER_SETTINGS_PA: RangeInclusive<f64> = 94_000.0..=106_000.0;

schema! {
    /// What an altitude refers to.
    ///
    /// ```
    /// use fcc_core::flight::AltitudeReference;
    ///
    /// assert_eq!(AltitudeReference::default(), AltitudeReference::PressureLevel);
    /// ```
    pub enum AltitudeReference {
        /// The pressure level of 1,013.25 hPa: a pressure altitude, in hundreds
        /// of feet a flight level. The altimeter setting has no effect.
        PressureLevel = 0,
        /// Mean sea level by the altimeter setting (QNH).
        SeaLevel = 1,
        /// The field whose elevation is configured: a height above it, by the
        /// altimeter setting. It is not a height above the ground elsewhere.
        Field = 2,
    }
}

impl AltitudeReference {
    /// Its name, as in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PressureLevel => "pressure-level",
            Self::SeaLevel => "sea-level",
            Self::Field => "field",
        }
    }
}

/// An altimeter.
///
/// ```
/// use fcc_core::flight::{Altimeter, AltitudeReference};
///
/// // Set to 29.4 inHg: add 485 ft to an altitude for the pressure altitude
/// // (FAA-H-8083-25C, figure 11-3).
/// let altimeter = Altimeter { setting_pa: 29.4 * 3_386.389, ..Altimeter::default() };
/// let datum_m = altimeter.datum_m(AltitudeReference::SeaLevel).unwrap();
/// assert!((datum_m / 0.304_8 - 485.0).abs() < 1.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Altimeter {
    /// The altimeter setting (QNH), Pa.
    pub setting_pa: f64,
    /// The elevation above mean sea level of the field that heights refer to,
    /// m; none if heights are not used.
    pub field_elevation_m: Option<f64>,
}

impl Default for Altimeter {
    /// Set to the standard pressure: altitudes are pressure altitudes.
    fn default() -> Self {
        Self {
            setting_pa: super::atmosphere::SEA_LEVEL_PRESSURE_PA,
            field_elevation_m: None,
        }
    }
}

impl Altimeter {
    /// The pressure altitude of the surface that an altitude refers to, m: the
    /// pressure altitude of a set point is this and the set point together.
    /// None if it is the field, and its elevation is unknown.
    pub fn datum_m(&self, reference: AltitudeReference) -> Option<f64> {
        match reference {
            AltitudeReference::PressureLevel => Some(0.0),
            AltitudeReference::SeaLevel => Some(pressure_altitude_m(self.setting_pa)),
            AltitudeReference::Field => {
                let elevation_m = self.field_elevation_m?;
                Some(pressure_altitude_m(self.setting_pa) + elevation_m)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INHG_PA: f64 = 3_386.389;
    const FOOT_M: f64 = 0.304_8;

    /// FAA-H-8083-25C, figure 11-3: altimeter setting in inHg, feet to be added
    /// to an indicated altitude for the pressure altitude.
    const TABLE: [(f64, f64); 8] = [
        (28.0, 1_824.0),
        (28.5, 1_340.0),
        (29.0, 863.0),
        (29.5, 392.0),
        (29.9, 20.0),
        (30.2, -257.0),
        (30.5, -531.0),
        (31.0, -983.0),
    ];

    fn datum_ft(setting_pa: f64) -> f64 {
        let altimeter = Altimeter {
            setting_pa,
            field_elevation_m: None,
        };
        altimeter.datum_m(AltitudeReference::SeaLevel).unwrap() / FOOT_M
    }

    #[test]
    fn agrees_with_the_pilots_table() {
        for (inhg, feet) in TABLE {
            let datum_ft = datum_ft(inhg * INHG_PA);
            assert!((datum_ft - feet).abs() < 1.0, "{inhg} inHg: {datum_ft} ft");
        }
    }

    /// ICAO Doc 7488: 1 hPa is 27.3 ft at sea level in the standard atmosphere.
    #[test]
    fn a_hectopascal_is_27_feet_at_sea_level() {
        let feet = datum_ft(101_275.0) - datum_ft(101_375.0);
        assert!((feet - 27.3).abs() < 0.1, "{feet}");
    }

    /// To the last bit: with the standard setting nothing is flown otherwise.
    #[test]
    fn at_the_standard_setting_an_altitude_is_a_pressure_altitude() {
        let datum_m = Altimeter::default().datum_m(AltitudeReference::SeaLevel);
        for altitude_m in [914.4, -123.4, 1e-9, 0.0] {
            assert_eq!(
                (altitude_m + datum_m.unwrap()).to_bits(),
                f64::to_bits(altitude_m)
            );
        }
    }

    /// Altitude 1,500 ft at 30.00 inHg over a field at 700 ft is 800 ft above
    /// it; by the pilots' table, 1,427 ft pressure altitude.
    #[test]
    fn a_height_is_above_the_field() {
        let mut altimeter = Altimeter {
            setting_pa: 30.0 * INHG_PA,
            field_elevation_m: None,
        };
        assert_eq!(altimeter.datum_m(AltitudeReference::Field), None);
        altimeter.field_elevation_m = Some(700.0 * FOOT_M);
        let datum_m = altimeter.datum_m(AltitudeReference::Field).unwrap();
        assert!((datum_m / FOOT_M + 800.0 - 1_427.0).abs() < 1.0);
        assert_eq!(
            altimeter.datum_m(AltitudeReference::PressureLevel),
            Some(0.0)
        );
    }
}
