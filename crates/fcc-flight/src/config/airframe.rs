//! `[autopilot.airframe]`: what a flight with an airspeed sensor has learned.

use std::f64::consts::PI;

use fcc_navigation::LearnedAirframe;
use serde::{Deserialize, Serialize};

/// One degree in rad.
const DEGREE_RAD: f64 = PI / 180.0;

/// `[autopilot.airframe]`: all of its keys, as `fccd replay` prints them after a flight
/// with an airspeed sensor.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AirframeSection {
    /// Force along x over weight that thrust and drag do not explain.
    pub axial_offset: f64,
    /// Thrust over weight at full throttle and the reference airspeed.
    pub full_thrust_ratio: f64,
    /// Angle of attack without lift, as attitude and path show it.
    pub zero_lift_angle_deg: f64,
    /// Angle of attack above that for 1 g at the reference airspeed.
    pub one_g_angle_deg: f64,
}

/// Key, smallest and largest value, as in the table of all keys.
pub(super) const RANGES: &[(&str, f64, f64)] = &[
    ("autopilot.airframe.axial_offset", -0.2, 0.2),
    ("autopilot.airframe.full_thrust_ratio", 0.02, 1.5),
    ("autopilot.airframe.zero_lift_angle_deg", -20.0, 20.0),
    ("autopilot.airframe.one_g_angle_deg", 0.3, 20.0),
];

impl From<AirframeSection> for LearnedAirframe {
    fn from(section: AirframeSection) -> Self {
        Self {
            axial_offset: section.axial_offset,
            full_thrust_ratio: section.full_thrust_ratio,
            zero_lift_angle_rad: section.zero_lift_angle_deg * DEGREE_RAD,
            one_g_angle_rad: section.one_g_angle_deg * DEGREE_RAD,
        }
    }
}

impl From<LearnedAirframe> for AirframeSection {
    fn from(learned: LearnedAirframe) -> Self {
        Self {
            axial_offset: learned.axial_offset,
            full_thrust_ratio: learned.full_thrust_ratio,
            zero_lift_angle_deg: learned.zero_lift_angle_rad / DEGREE_RAD,
            one_g_angle_deg: learned.one_g_angle_rad / DEGREE_RAD,
        }
    }
}

impl AirframeSection {
    /// The section as it stands in a configuration file.
    pub fn to_toml(self) -> String {
        format!(
            "[autopilot.airframe]\naxial_offset = {:.5}\nfull_thrust_ratio = {:.4}\n\
             zero_lift_angle_deg = {:.3}\none_g_angle_deg = {:.3}\n",
            self.axial_offset,
            self.full_thrust_ratio,
            self.zero_lift_angle_deg,
            self.one_g_angle_deg
        )
    }
}

#[cfg(test)]
mod tests {
    use fcc_navigation::LearnedAirframe;

    use super::AirframeSection;
    use crate::config::Config;

    fn parsed(text: &str) -> Result<Option<LearnedAirframe>, String> {
        let config = Config::parse_without_aircraft(text, "f");
        let config = config.map_err(|error| error.to_string())?;
        Ok(config.autopilot_config().airframe)
    }

    #[test]
    fn what_was_learned_is_read_as_it_was_printed() {
        let learned = LearnedAirframe {
            axial_offset: -0.012_5,
            full_thrust_ratio: 0.262,
            zero_lift_angle_rad: (-2.125_f64).to_radians(),
            one_g_angle_rad: 3.75_f64.to_radians(),
        };
        let read = parsed(&AirframeSection::from(learned).to_toml()).unwrap();
        assert_eq!(read, Some(learned));
        assert_eq!(parsed("").unwrap(), None);
    }

    #[test]
    fn a_key_that_is_missing_or_impossible_is_named() {
        let text = "[autopilot.airframe]\naxial_offset = 0.0\nfull_thrust_ratio = 0.25\n\
                    zero_lift_angle_deg = -2.0\n";
        let refused = parsed(text).unwrap_err();
        assert!(refused.contains("one_g_angle_deg"), "{refused}");
        let text = format!("{text}one_g_angle_deg = 40.0\n");
        let refused = parsed(&text).unwrap_err();
        assert!(
            refused.starts_with("f:5: autopilot.airframe.one_g_angle_deg"),
            "{refused}"
        );
    }
}
