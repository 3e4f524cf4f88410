//! X-Plane's units and their conversion to SI.

use fcc_core::units::INHG_PA;

/// One international knot in m/s: 1852 m an hour (BIPM, The International
/// System of Units, 8th ed. 2006, table 8), exact.
pub(crate) const KNOT_MPS: f64 = 1852.0 / 3600.0;
/// One international foot in m (1959), exact.
pub(crate) const FOOT_M: f64 = 0.3048;
/// Standard gravity in m/s² (3rd CGPM, 1901), exact.
pub(crate) const GRAVITY_MPS2: f64 = 9.806_65;

/// A unit that X-Plane uses.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Unit {
    Seconds,
    /// 0 or 1.
    Flag,
    /// A number without a unit.
    Number,
    Ratio,
    MetresPerSecond,
    MetresPerSecondSquared,
    RadiansPerSecond,
    Degrees,
    Knots,
    Feet,
    Gravities,
    InchesOfMercury,
    Pascals,
    Metres,
    RevolutionsPerMinute,
    Volts,
}

impl Unit {
    pub(crate) fn to_si(self, value: f64) -> f64 {
        match self {
            // Units that are used internally, too.
            Self::Seconds
            | Self::Flag
            | Self::Number
            | Self::Ratio
            | Self::MetresPerSecond
            | Self::MetresPerSecondSquared
            | Self::RadiansPerSecond
            | Self::Pascals
            | Self::Metres
            | Self::Volts => value,
            Self::Degrees => value.to_radians(),
            Self::Knots => value * KNOT_MPS,
            Self::Feet => value * FOOT_M,
            Self::Gravities => value * GRAVITY_MPS2,
            Self::InchesOfMercury => value * INHG_PA,
            Self::RevolutionsPerMinute => value * (core::f64::consts::TAU / 60.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_are_the_published_ones() {
        // The tropopause of ISO 2533, 11 000 m, is at 36 089.24 ft.
        assert!((Unit::Feet.to_si(36_089.238_845) - 11_000.0).abs() < 1e-6);
        // 100 kt are 185.2 km/h.
        assert!((Unit::Knots.to_si(100.0) * 3.6 - 185.2).abs() < 1e-12);
        // One radian is 57.295 779 513 082° (Abramowitz and Stegun 1964, table 1.1).
        assert!((Unit::Degrees.to_si(57.295_779_513_082_32) - 1.0).abs() < 1e-15);
        assert!((Unit::Gravities.to_si(2.0) - 19.6133).abs() < 1e-12);
    }
}
