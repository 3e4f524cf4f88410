//! The message for a set point outside its limits.

use std::fmt;
use std::ops::RangeInclusive;

use crate::units::{Shown, number};
use fcc_core::framework::schema::unit;
use serde::{Deserialize, Serialize};

/// A value this close to a limit counts as on it: a round limit in knots or
/// feet is not round in SI units.
const ROUNDING: f64 = 0.005;

/// Of this set point 0 is no item: it resumes the plan.
const RESUMES_AT_0: &str = "plan_item";

/// A set point out of its limits, in the unit at the end of its name.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct OutsideLimits {
    /// Its name: `airspeed_mps`.
    pub name: String,
    /// The value commanded.
    pub value: f64,
    /// The smallest permitted value.
    pub least: f64,
    /// The largest permitted value.
    pub most: f64,
}

impl OutsideLimits {
    /// The error if a value is out of its limits, or the number of an item is no whole one;
    /// none if it is within.
    pub fn of(name: &str, value: f64, limits: &RangeInclusive<f64>) -> Option<Self> {
        let (least, most) = (*limits.start(), *limits.end());
        let is_number = name != RESUMES_AT_0 || value.fract() == 0.0;
        let inside = is_number && (least - ROUNDING..=most + ROUNDING).contains(&value);
        (!inside).then_some(Self {
            name: name.to_owned(),
            value,
            least,
            most,
        })
    }

    /// As text, in those of these units that fit.
    pub fn text_in(&self, units: &[Shown]) -> String {
        let own = unit::of(&self.name).unit;
        let shown = units.iter().find(|unit| self.name.ends_with(unit.end));
        let (unit, factor) = shown.map_or((own, 1.0), |shown| (shown.unit, shown.scale));
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
        let space = if unit == "°" || unit.is_empty() {
            ""
        } else {
            " "
        };
        let quantity = quantity(&self.name);
        if self.name == RESUMES_AT_0 {
            return format!("{quantity} is {value}: the plan has items 1 to {most}");
        }
        format!("{quantity} is {value}{space}{unit}: choose {least} to {most}{space}{unit}")
    }
}

/// What a set point is, by its name: `pressure altitude`.
pub(super) fn quantity(name: &str) -> String {
    unit::of(name).quantity.replace('_', " ")
}

impl std::error::Error for OutsideLimits {}

impl fmt::Display for OutsideLimits {
    /// In the unit at the end of its name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text_in(&[]))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use crate::units::AVIATION;

    use super::*;

    /// 1 kt is 1852 m in an hour, 1 ft is 0.3048 m.
    #[test]
    fn limits_are_printed_in_both_units_and_accepted_as_printed() {
        let airspeeds = 37.554_445..=65.334_444;
        let outside = |mps| OutsideLimits::of("airspeed_mps", mps, &airspeeds);
        let fast = outside(300.0 * 1852.0 / 3600.0).unwrap();
        assert_eq!(
            fast.text_in(AVIATION),
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
        let altitude = OutsideLimits::of("altitude_m", 21_000.0, &(-500.0..=20_000.0)).unwrap();
        assert_eq!(
            altitude.text_in(AVIATION),
            "altitude is 68897.64 ft: choose -1640.42 to 65616.8 ft"
        );
        let heading = OutsideLimits::of("heading_rad", 7.0, &(-TAU..=TAU)).unwrap();
        assert_eq!(
            heading.text_in(AVIATION),
            "heading is 401.07°: choose -360 to 360°"
        );
        let item = OutsideLimits::of("plan_item", 2.5, &(0.0..=9.0)).unwrap();
        assert_eq!(
            item.text_in(AVIATION),
            "plan item is 2.5: the plan has items 1 to 9"
        );
        let item = OutsideLimits::of("plan_item", 99.0, &(0.0..=9.0)).unwrap();
        assert_eq!(
            item.text_in(AVIATION),
            "plan item is 99: the plan has items 1 to 9"
        );
        let room = OutsideLimits::of("room_c", 99.0, &(5.0..=30.0)).unwrap();
        assert_eq!(room.to_string(), "room is 99 °C: choose 5 to 30 °C");
    }
}
