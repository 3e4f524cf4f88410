//! What may be commanded, and the message where something else was.

use std::f64::consts::TAU;
use std::fmt;
use std::ops::RangeInclusive;

use fcc_telemetry::units::{M_FT, MPS_KT};

/// What no command is beyond, whatever is flown.
const AIRSPEED_MPS: RangeInclusive<f64> = 5.0..=340.0;
const HEADING_RAD: RangeInclusive<f64> = -TAU..=TAU;
const ALTITUDE_M: RangeInclusive<f64> = -500.0..=20_000.0;

/// So near a limit counts as on it: a limit that is even in knots or feet is
/// not in SI.
const ROUNDING: f64 = 0.005;

/// What a set point sets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Quantity {
    /// Indicated airspeed, m/s.
    Airspeed,
    /// Magnetic heading, rad.
    Heading,
    /// Barometric altitude, m.
    Altitude,
}

impl Quantity {
    /// What may be commanded of it, whatever is flown.
    pub(super) const fn range(self) -> RangeInclusive<f64> {
        match self {
            Self::Airspeed => AIRSPEED_MPS,
            Self::Heading => HEADING_RAD,
            Self::Altitude => ALTITUDE_M,
        }
    }
}

/// A set point beyond its limits, in SI units.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OutsideLimits {
    /// What it sets.
    pub quantity: Quantity,
    /// What was commanded.
    pub value: f64,
    /// The least that may be.
    pub least: f64,
    /// The most that may be.
    pub most: f64,
}

impl OutsideLimits {
    /// Whether a value is outside; none if it may be commanded.
    pub fn of(quantity: Quantity, value: f64, limits: &RangeInclusive<f64>) -> Option<Self> {
        let (least, most) = (*limits.start(), *limits.end());
        let inside = (least - ROUNDING..=most + ROUNDING).contains(&value);
        (!inside).then_some(Self {
            quantity,
            value,
            least,
            most,
        })
    }

    /// In the units of the command line: knots, degrees, feet.
    pub fn in_knots_degrees_feet(&self) -> String {
        match self.quantity {
            Quantity::Airspeed => self.words(MPS_KT, "kt"),
            Quantity::Heading => self.words(1.0_f64.to_degrees(), "°"),
            Quantity::Altitude => self.words(M_FT, "ft"),
        }
    }

    fn words(&self, factor: f64, unit: &str) -> String {
        let name = match self.quantity {
            Quantity::Airspeed => "airspeed",
            Quantity::Heading => "heading",
            Quantity::Altitude => "altitude",
        };
        // To a hundredth: what is printed as a limit is taken.
        let [value, least, most] = [self.value, self.least, self.most]
            .map(|number| (number * factor * 100.0).round() / 100.0);
        let space = if unit == "°" { "" } else { " " };
        format!("{name} is {value}{space}{unit}: choose {least} to {most}{space}{unit}")
    }
}

impl std::error::Error for OutsideLimits {}

impl fmt::Display for OutsideLimits {
    /// In SI units.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&match self.quantity {
            Quantity::Airspeed => self.words(1.0, "m/s"),
            Quantity::Heading => self.words(1.0, "rad"),
            Quantity::Altitude => self.words(1.0, "m"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 kt is 1852 m in an hour, 1 ft is 0.3048 m.
    #[test]
    fn limits_are_said_in_either_units_and_are_taken_as_they_are_said() {
        let airspeeds = 37.554_445..=65.334_444;
        let outside = |mps| OutsideLimits::of(Quantity::Airspeed, mps, &airspeeds);
        let fast = outside(300.0 * 1852.0 / 3600.0).unwrap();
        assert_eq!(
            fast.in_knots_degrees_feet(),
            "airspeed is 300 kt: choose 73 to 127 kt"
        );
        assert_eq!(
            fast.to_string(),
            "airspeed is 154.33 m/s: choose 37.55 to 65.33 m/s"
        );
        for mps in [
            73.0 * 1852.0 / 3600.0,
            127.0 * 1852.0 / 3600.0,
            37.55,
            65.33,
        ] {
            assert_eq!(outside(mps), None, "{mps}");
        }
        assert!(outside(f64::NAN).is_some());
        let altitude = OutsideLimits::of(Quantity::Altitude, 21_000.0, &ALTITUDE_M).unwrap();
        assert_eq!(
            altitude.in_knots_degrees_feet(),
            "altitude is 68897.64 ft: choose -1640.42 to 65616.8 ft"
        );
        let heading = OutsideLimits::of(Quantity::Heading, 7.0, &HEADING_RAD).unwrap();
        assert_eq!(
            heading.in_knots_degrees_feet(),
            "heading is 401.07°: choose -360 to 360°"
        );
    }
}
