//! Limits of commands, and the message for a value outside them.

use std::fmt;
use std::ops::RangeInclusive;

#[cfg(feature = "flight")]
use fcc_core::flight::AutopilotCommand;
use fcc_telemetry::units::{
    COMMANDED_ALTIMETER_SETTING_PA, COMMANDED_ALTITUDE_M, COMMANDED_HEADING_RAD, M_FT, MPS_KT,
    PA_HPA, number,
};

/// Limits for any aircraft.
const AIRSPEED_MPS: RangeInclusive<f64> = 5.0..=340.0;

/// A value this close to a limit counts as on it: a round limit in knots or
/// feet is not round in SI units.
const ROUNDING: f64 = 0.005;

/// The quantity of a set point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Quantity {
    /// Indicated airspeed, m/s.
    Airspeed,
    /// Magnetic heading, rad.
    Heading,
    /// Altitude above mean sea level by the altimeter setting, m.
    Altitude,
    /// Pressure altitude, m.
    PressureAltitude,
    /// Height above the field's elevation, m.
    Height,
    /// Altimeter setting, Pa.
    AltimeterSetting,
}

impl Quantity {
    /// Its limits, for any aircraft.
    pub(super) const fn range(self) -> RangeInclusive<f64> {
        match self {
            Self::Airspeed => AIRSPEED_MPS,
            Self::Heading => COMMANDED_HEADING_RAD,
            Self::Altitude | Self::PressureAltitude | Self::Height => COMMANDED_ALTITUDE_M,
            Self::AltimeterSetting => COMMANDED_ALTIMETER_SETTING_PA,
        }
    }

    pub(super) const fn is_altitude(self) -> bool {
        matches!(self, Self::Altitude | Self::PressureAltitude | Self::Height)
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Airspeed => "airspeed",
            Self::Heading => "heading",
            Self::Altitude => "altitude",
            Self::PressureAltitude => "pressure altitude",
            Self::Height => "height",
            Self::AltimeterSetting => "altimeter setting",
        }
    }

    /// The command to the autopilot.
    #[cfg(feature = "flight")]
    pub(super) const fn command(self, value: f64) -> AutopilotCommand {
        match self {
            Self::Airspeed => AutopilotCommand::Airspeed(value),
            Self::Heading => AutopilotCommand::Heading(value),
            Self::Altitude => AutopilotCommand::Altitude(value),
            Self::PressureAltitude => AutopilotCommand::PressureAltitude(value),
            Self::Height => AutopilotCommand::Height(value),
            Self::AltimeterSetting => AutopilotCommand::AltimeterSetting(value),
        }
    }
}

/// A set point out of its limits, in SI units.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OutsideLimits {
    /// Its quantity.
    pub quantity: Quantity,
    /// The value commanded.
    pub value: f64,
    /// The smallest permitted value.
    pub least: f64,
    /// The largest permitted value.
    pub most: f64,
}

impl OutsideLimits {
    /// The error if a value is out of its limits; none if it is within.
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
            Quantity::Airspeed => self.text_in(MPS_KT, "kt"),
            Quantity::Heading => self.text_in(1.0_f64.to_degrees(), "°"),
            Quantity::Altitude | Quantity::PressureAltitude | Quantity::Height => {
                self.text_in(M_FT, "ft")
            }
            Quantity::AltimeterSetting => self.text_in(PA_HPA, "hPa"),
        }
    }

    fn text_in(&self, factor: f64, unit: &str) -> String {
        let name = self.quantity.name();
        // To a hundredth: a value printed as a limit is accepted.
        let round = |number: f64| (number * factor * 100.0).round() / 100.0;
        let (least, most) = (round(self.least), round(self.most));
        // A huge one has no hundredths, and times a hundred it may be infinite.
        let is_huge = self.value.abs() > 1e12;
        let value = number(if is_huge {
            self.value * factor
        } else {
            round(self.value)
        });
        let space = if unit == "°" { "" } else { " " };
        format!("{name} is {value}{space}{unit}: choose {least} to {most}{space}{unit}")
    }
}

impl std::error::Error for OutsideLimits {}

impl fmt::Display for OutsideLimits {
    /// In SI units.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&match self.quantity {
            Quantity::Airspeed => self.text_in(1.0, "m/s"),
            Quantity::Heading => self.text_in(1.0, "rad"),
            Quantity::Altitude | Quantity::PressureAltitude | Quantity::Height => {
                self.text_in(1.0, "m")
            }
            Quantity::AltimeterSetting => self.text_in(1.0, "Pa"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 kt is 1852 m in an hour, 1 ft is 0.3048 m.
    #[test]
    fn limits_are_printed_in_both_units_and_accepted_as_printed() {
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
        let huge = outside(1e300).unwrap().to_string();
        assert_eq!(huge, "airspeed is 1e300 m/s: choose 37.55 to 65.33 m/s");
        let altitude =
            OutsideLimits::of(Quantity::Altitude, 21_000.0, &COMMANDED_ALTITUDE_M).unwrap();
        assert_eq!(
            altitude.in_knots_degrees_feet(),
            "altitude is 68897.64 ft: choose -1640.42 to 65616.8 ft"
        );
        let heading = OutsideLimits::of(Quantity::Heading, 7.0, &COMMANDED_HEADING_RAD).unwrap();
        assert_eq!(
            heading.in_knots_degrees_feet(),
            "heading is 401.07°: choose -360 to 360°"
        );
    }
}
