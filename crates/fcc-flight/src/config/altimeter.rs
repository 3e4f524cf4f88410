//! `[altimeter]`: the altimeter setting, and what heights refer to.

use fcc_core::flight::Altimeter;
use fcc_core::units::{FOOT_M, HECTOPASCAL_PA};
use serde::{Deserialize, Serialize};

/// The standard pressure.
const STANDARD_HPA: f64 = 1_013.25;

/// `[altimeter]`.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct AltimeterSection {
    /// The altimeter setting (QNH) at the start; a command changes it.
    pub setting_hpa: f64,
    /// The elevation of the field that heights refer to; without it no height
    /// can be commanded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field_elevation_ft: Option<f64>,
}

impl Default for AltimeterSection {
    fn default() -> Self {
        Self {
            setting_hpa: STANDARD_HPA,
            field_elevation_ft: None,
        }
    }
}

impl From<&AltimeterSection> for Altimeter {
    fn from(section: &AltimeterSection) -> Self {
        Self {
            setting_pa: section.setting_hpa * HECTOPASCAL_PA,
            field_elevation_m: section.field_elevation_ft.map(|feet| feet * FOOT_M),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::config::Config;

    fn altimeter(text: &str) -> Result<(f64, Option<f64>), String> {
        let text = format!("[built-in]\n[altimeter]\n{text}");
        let config = Config::parse(&text, "f").map_err(|error| error.to_string())?;
        let altimeter = config.autopilot_config().altimeter;
        Ok((altimeter.setting_pa, altimeter.field_elevation_m))
    }

    #[test]
    fn without_keys_it_is_the_standard_setting() {
        assert_eq!(altimeter(""), Ok((101_325.0, None)));
    }

    /// Milwaukee's elevation is 723 ft, 220.4 m.
    #[test]
    fn setting_and_elevation_are_read() {
        let (setting_pa, elevation_m) =
            altimeter("setting_hpa = 998.5\nfield_elevation_ft = 723.0").unwrap();
        assert!((setting_pa - 99_850.0).abs() < 1e-9);
        assert!((elevation_m.unwrap() - 220.4).abs() < 0.05);
    }

    #[test]
    fn inches_of_mercury_are_refused_with_the_range() {
        let words = altimeter("setting_hpa = 29.92").unwrap_err();
        assert_eq!(
            words,
            "f:3: altimeter.setting_hpa: is 29.92: choose 940 to 1060"
        );
    }
}
