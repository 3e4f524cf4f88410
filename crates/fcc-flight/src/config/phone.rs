//! `[[sensor]]` of the kind `phone`.

use std::time::Duration;

use fcc_core::framework::FALLBACK_AFTER;
use serde::{Deserialize, Serialize};

use super::CalibrationSection;

/// The sensors of the phone that the program runs on: in the Android app alone.
///
/// What they give is in Android's axes: x to the right of the screen, y to its top, z
/// out of it. How the phone lies in the aircraft is the calibration's `mounting`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a key of the configuration"
)]
pub struct PhoneSection {
    /// Events in a second that each sensor is asked for.
    pub rate_hz: f64,
    /// Whether its magnetometer is used.
    pub magnetometer: bool,
    /// Whether its barometer is used; not every phone has one.
    pub barometer: bool,
    /// Whether the positions of its location service are used.
    pub position: bool,
    /// Whether the biases that the phone has estimated, as they are at first, are
    /// subtracted.
    pub own_bias: bool,
    /// A sensor counts as silent after this long without an event.
    pub silent_after_ms: u64,
    /// After this long without a reading, that of the next sensor in the order
    /// is used.
    pub fallback_after_ms: u64,
    /// The calibration of its readings.
    #[serde(skip_serializing_if = "CalibrationSection::is_default")]
    pub calibration: CalibrationSection,
}

impl Default for PhoneSection {
    fn default() -> Self {
        Self {
            rate_hz: 100.0,
            magnetometer: true,
            barometer: true,
            position: true,
            own_bias: true,
            silent_after_ms: 500,
            fallback_after_ms: FALLBACK_AFTER.as_millis() as u64,
            calibration: CalibrationSection::default(),
        }
    }
}

impl PhoneSection {
    /// After how long without an event a sensor is silent, and without a reading the
    /// next one in the order is used.
    pub fn patience(&self) -> (Duration, Duration) {
        (
            Duration::from_millis(self.silent_after_ms),
            Duration::from_millis(self.fallback_after_ms),
        )
    }
}

#[cfg(test)]
mod tests {
    use crate::config::Config;
    use crate::flight::{AssemblyError, assemble};

    const PHONE: &str =
        "actuator = []\n[navigation]\nmethod = \"kalman\"\n[[sensor]]\nkind = \"phone\"\n";

    #[test]
    fn a_phone_is_a_sensor_of_the_app_alone() {
        let config = Config::parse(PHONE, "test").unwrap();
        let refused = assemble(&config).err().unwrap();
        assert!(matches!(refused, AssemblyError::NoPhone));
        assert!(refused.to_string().contains("Android app"), "{refused}");
    }

    #[test]
    fn a_phone_has_a_calibration_and_is_there_once() {
        let mounted = format!(
            "{PHONE}calibration.gyroscope.mounting = \"left-forward-down\"\nbarometer = false\n"
        );
        let config = Config::parse(&mounted, "test").unwrap();
        let [source] = &config.raw_sources()[..] else {
            panic!("one source");
        };
        assert_eq!(
            (source.place.as_str(), source.sensor.as_str()),
            ("sensor[0]", "phone")
        );
        let mounting = source.calibration.gyroscope.mounting;
        assert_eq!(mounting.to_string(), "left-forward-down");
        let again = Config::parse(&config.to_toml().unwrap(), "again").unwrap();
        assert_eq!(again.to_toml().unwrap(), config.to_toml().unwrap());
        // As in the thesis' experiment: airspeed, switch and surfaces are X-Plane's.
        let with_x_plane = PHONE.replace("actuator = []", "[x-plane]\nengage_switch = \"a/b\"");
        Config::parse(&with_x_plane, "test").unwrap();
        let twice = format!("{PHONE}[[sensor]]\nkind = \"phone\"\n");
        assert_eq!(
            Config::parse(&twice, "test").unwrap_err().to_string(),
            "test:7: sensor[1].kind: is the phone a second time: keep one"
        );
    }
}
