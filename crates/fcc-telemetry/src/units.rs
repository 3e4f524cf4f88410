//! The units in which people read values.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use fcc_core::units::FOOT_M;
pub use fcc_core::units::GRAVITY_MPS2 as G_MPS2;

use crate::schema::Column;

/// Feet per metre.
pub const M_FT: f64 = 1.0 / FOOT_M;

/// Knots per metre per second.
pub const MPS_KT: f64 = 3_600.0 / 1_852.0;

/// Headings that may be commanded, rad: the sum of two headings, too.
pub const COMMANDED_HEADING_RAD: RangeInclusive<f64> = -2.0 * TAU..=2.0 * TAU;

/// Altitudes that may be commanded, m.
pub const COMMANDED_ALTITUDE_M: RangeInclusive<f64> = -500.0..=20_000.0;

/// Altimeter settings that may be commanded, Pa.
pub const COMMANDED_ALTIMETER_SETTING_PA: RangeInclusive<f64> = 94_000.0..=106_000.0;

/// Hectopascals per pascal.
pub const PA_HPA: f64 = 0.01;

/// A number as a message gives it; a very large or small one without hundreds of zeros.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-6..1e16).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// The unit in which people read the values whose names end in `end`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Shown {
    /// The end of the name of a column: `_mps`.
    pub end: &'static str,
    /// The unit; empty if there is none.
    pub unit: &'static str,
    /// That many of it in one of the record's unit.
    pub scale: f64,
}

const fn shown(end: &'static str, unit: &'static str, scale: f64) -> Shown {
    Shown { end, unit, scale }
}

const RAD_DEG: f64 = 180.0 / std::f64::consts::PI;

/// SI units, and degrees for angles.
pub const SI: &[Shown] = &[
    shown("_rad", "°", RAD_DEG),
    shown("_radps", "°/s", RAD_DEG),
    shown("_radps2", "°/s²", RAD_DEG),
];

/// The units of aviation: feet, knots, feet per minute, degrees.
pub const AVIATION: &[Shown] = &[
    shown("climb_rate_mps", "ft/min", 60.0 * M_FT),
    shown("_mps", "kt", MPS_KT),
    shown("_m", "ft", M_FT),
    shown("_rad", "°", RAD_DEG),
    shown("_radps", "°/s", RAD_DEG),
    shown("_radps2", "°/s²", RAD_DEG),
    shown("_pa", "hPa", PA_HPA),
];

impl Shown {
    /// The unit of a column: the first of `units` whose end fits, percent for a
    /// fraction, or else the record's own.
    pub fn of(column: &Column, units: &[Self]) -> Self {
        let mut units = units.iter();
        if let Some(found) = units.find(|shown| column.name.ends_with(shown.end)) {
            return *found;
        }
        let is_fraction = |(low, high): (f64, f64)| (low == 0.0 || low == -1.0) && high == 1.0;
        if column.unit.is_empty() && column.range.is_some_and(is_fraction) {
            return shown("", "%", 100.0);
        }
        shown("", column.unit, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::columns;

    fcc_core::schema! {
        /// Of all kinds.
        #[derive(Clone, Copy, PartialEq, Debug, Default)]
        struct Every {
            /// A height.
            #[field(1)]
            altitude_m: f64,
            /// A speed.
            #[field(2)]
            climb_rate_mps: f64,
            /// A speed.
            #[field(3)]
            airspeed_mps: f64,
            /// A fraction.
            #[field(4, range = -1.0..=1.0)]
            elevator: f64,
            /// A temperature.
            #[field(5)]
            room_c: f64,
            /// An angle.
            #[field(6)]
            tilt_rad: f64,
        }
    }

    /// 1 m is 3.28084 ft, 1 m/s is 196.850 ft/min or 1.94384 kt (ISO 80000-3).
    #[test]
    fn a_value_is_read_in_the_unit_of_its_field() {
        let of = |units: &[Shown]| -> Vec<_> {
            let columns = columns::<Every>();
            let shown = columns.iter().map(|column| Shown::of(column, units));
            shown
                .map(|shown| format!("{:.3} {}", shown.scale, shown.unit))
                .collect()
        };
        let aviation = ["3.281 ft", "196.850 ft/min", "1.944 kt"];
        assert_eq!(of(AVIATION)[..3], aviation);
        assert_eq!(of(SI)[..3], ["1.000 m", "1.000 m/s", "1.000 m/s"]);
        for units in [AVIATION, SI] {
            assert_eq!(of(units)[3..], ["100.000 %", "1.000 °C", "57.296 °"]);
        }
    }
}
