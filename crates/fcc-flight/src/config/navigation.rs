//! `[navigation]`: where attitude and the other quantities that control needs
//! come from.

use std::time::Duration;

use fcc_navigation::inertial::{MagneticNorth, RawNavigationConfig};
use serde::{Deserialize, Serialize};

use super::{Config, DeviceEntry, RawSensorsChoice, SensorEntry};

/// The middle of the World Magnetic Model 2025: a small computer may not know
/// the date, and a declination changes by 0.1 to 0.2° a year.
const MIDDLE_OF_THE_MODEL: f64 = 2027.5;

/// `[navigation]`.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct NavigationSection {
    /// How they are computed from raw readings, or that sensors measure them.
    pub method: NavigationMethod,
    /// By how much the latest reading of any sensor comes after it was taken.
    pub longest_delay_ms: f64,
    /// The earth's magnetic field here: north, east, down. Without it, that of
    /// the World Magnetic Model at the first fix of a satellite receiver, and of
    /// the built-in aircraft its own.
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "super::exactly::numbers_if_given"
    )]
    pub magnetic_field_ut: Option<[f64; 3]>,
    /// The year of that model, with its fraction.
    pub year: f64,
}

/// How attitude is computed.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NavigationMethod {
    /// Sensors measure it.
    #[default]
    Measured,
    /// From raw readings, by a Kalman filter.
    Kalman,
}

impl Default for NavigationSection {
    fn default() -> Self {
        Self {
            method: NavigationMethod::Measured,
            longest_delay_ms: 200.0,
            magnetic_field_ut: None,
            year: MIDDLE_OF_THE_MODEL,
        }
    }
}

/// As far back as the filter keeps samples.
pub(super) const LONGEST_DELAY_MS: f64 = 500.0;

/// Reports a method that has nothing to compute attitude from. A program's own
/// aircraft stands in the place of a simulator's, and gives what it likes.
pub(super) fn check(config: &Config, report: &mut impl FnMut(&[&str], String)) {
    let is_by_filter = config.navigation.is_by_filter();
    if is_by_filter && config.is_without_simulator() && !config.has_inertial_unit() {
        let message = "computes attitude with gyroscopes, and no sensor has them: add one with \
                       kind = \"icm42688\", \"mpu6050\" or \"iio\", or choose \"measured\" to read \
                       the others without engaging";
        report(&["navigation.method"], message.to_owned());
    }
}

impl Config {
    /// Whether a sensor may have an accelerometer and gyroscopes. What a driver of
    /// the kernel gives is known only when it is opened.
    pub(super) fn has_inertial_unit(&self) -> bool {
        let is_simulated = self
            .built_in
            .as_ref()
            .is_some_and(|section| section.raw_sensors != RawSensorsChoice::None);
        is_simulated
            || self.devices().any(|(_, device)| match device {
                DeviceEntry::Chip(section) => section.kind.is_inertial(),
                device => device.is_board(),
            })
    }
}

impl Config {
    /// That a board has nothing to find its airspeed with, if it certainly has not.
    pub(super) fn airspeed_remark(&self) -> Option<String> {
        let gives_airspeed = |entry: &SensorEntry| match entry.device() {
            Some(DeviceEntry::Chip(section)) => section.kind.measures_airspeed(),
            // Not known before it is opened.
            Some(DeviceEntry::Iio(_)) => true,
            Some(_) => false,
            None => matches!(entry, SensorEntry::XPlane(_) | SensorEntry::ServoBoard(_)),
        };
        let is_by_board = self.is_without_simulator() && self.navigation.is_by_filter();
        if !is_by_board || self.sensor.iter().any(gives_airspeed) {
            return None;
        }
        let lacks = match (self.autopilot.airframe, self.receivers().next()) {
            (Some(_), Some(_)) => return None,
            (Some(_), None) => "no satellite receiver",
            (None, Some(_)) => "no [autopilot.airframe]",
            (None, None) => "neither a satellite receiver nor [autopilot.airframe]",
        };
        Some(format!(
            "no sensor measures the airspeed, and there is {lacks} to fly without one: nothing \
             will engage (docs/navigation.md, without an airspeed sensor)"
        ))
    }
}

/// Key, smallest and largest value, as in the table of all keys.
pub(super) const RANGES: &[(&str, f64, f64)] = &[
    ("navigation.longest_delay_ms", 0.0, LONGEST_DELAY_MS),
    ("navigation.magnetic_field_ut", -70.0, 70.0),
    ("navigation.year", 2_020.0, 2_029.999),
];

impl NavigationSection {
    /// Whether raw readings go into the filter, which waits for delayed ones.
    pub(crate) fn is_by_filter(&self) -> bool {
        self.method == NavigationMethod::Kalman
    }

    /// The core's configuration; none if sensors measure everything. Of a
    /// simulation the magnetic field is known.
    pub(super) fn to_core(self, simulated_ut: Option<[f64; 3]>) -> Option<RawNavigationConfig> {
        let delay = Duration::try_from_secs_f64(self.longest_delay_ms * 1e-3);
        self.is_by_filter().then(|| RawNavigationConfig {
            // The table of ranges refuses what is no delay.
            delay: delay.unwrap_or_default(),
            north: match self.magnetic_field_ut.or(simulated_ut) {
                Some(field) => MagneticNorth::Field(field),
                None => MagneticNorth::ModelOf(self.year),
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use fcc_navigation::inertial::MagneticNorth;

    use crate::config::Config;

    fn parsed(text: &str) -> Result<Config, String> {
        let text = format!("[navigation]\n{text}");
        Config::parse_without_aircraft(&text, "f").map_err(|error| error.to_string())
    }

    #[test]
    fn without_keys_sensors_measure_attitude() {
        let config = parsed("").unwrap();
        assert_eq!(config.autopilot_config().raw_navigation, None);
    }

    #[test]
    fn a_method_is_read_with_what_is_known() {
        let text = "method = \"kalman\"\nlongest_delay_ms = 150\n\
                    magnetic_field_ut = [19.0, -1.0, 49.0]";
        let raw = parsed(text).unwrap().autopilot_config().raw_navigation;
        let raw = raw.unwrap();
        assert_eq!(raw.delay, Duration::from_millis(150));
        assert_eq!(raw.north, MagneticNorth::Field([19.0, -1.0, 49.0]));
        let raw = parsed("method = \"kalman\"").unwrap().autopilot_config();
        let north = raw.raw_navigation.unwrap().north;
        assert_eq!(north, MagneticNorth::ModelOf(2027.5));
    }

    #[test]
    fn the_field_around_the_built_in_aircraft_is_known() {
        let text = "[built-in]\nraw_sensors = \"board\"\n[navigation]\nmethod = \"kalman\"";
        let config = Config::parse(text, "f").unwrap().autopilot_config();
        let MagneticNorth::Field(field) = config.raw_navigation.unwrap().north else {
            panic!("not known");
        };
        // Some 50 µT in middle latitudes.
        let strength = field.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!((45.0..60.0).contains(&strength), "{strength}");
    }

    #[test]
    fn where_nothing_gives_raw_readings_it_is_said() {
        let text = "[x-plane]\n[navigation]\nmethod = \"kalman\"\n";
        let refused = Config::parse(text, "f").unwrap_err().to_string();
        assert!(
            refused.starts_with("f:3: navigation.method: computes"),
            "{refused}"
        );
        let text = text.replace("x-plane", "built-in");
        let remarks = Config::parse(&text, "f").unwrap().remarks(&text);
        assert!(
            remarks.iter().any(|remark| remark.contains("raw_sensors")),
            "{remarks:?}"
        );
    }

    #[test]
    fn a_board_without_an_inertial_unit_is_refused() {
        let with = |method: &str, kinds: &[&str]| {
            let sensors = kinds.iter().fold(String::new(), |text, kind| {
                format!("{text}[[sensor]]\nkind = \"{kind}\"\n")
            });
            let text = format!("actuator = []\n[navigation]\nmethod = \"{method}\"\n{sensors}");
            Config::parse(&text, "f").map_err(|error| error.to_string())
        };
        let others = ["bmp388", "qmc5883l", "ms4525do", "gpsd", "x-plane"];
        let words = "f:3: navigation.method: computes attitude with gyroscopes, and no sensor has \
                     them: add one with kind = \"icm42688\"";
        let refused = with("kalman", &others).unwrap_err();
        assert!(refused.starts_with(words), "{refused}");
        with("measured", &others).unwrap();
        for unit in ["icm42688", "mpu6050", "iio\"\ndevice = \"mpu6050"] {
            with("kalman", &["bmp388", unit]).unwrap();
        }
    }

    #[test]
    fn beside_the_built_in_aircraft_it_is_a_remark() {
        let text = "[built-in]\n[navigation]\nmethod = \"kalman\"\n[[sensor]]\nkind = ";
        let says = |kind: &str| {
            let text = format!("{text}{kind}\n");
            let remarks = Config::parse(&text, "f").unwrap().remarks(&text);
            let mut remarks = remarks.iter();
            remarks.any(|remark| remark.contains("built-in.raw_sensors is \"none\""))
        };
        assert!(says("\"bmp388\""));
        assert!(!says("\"icm42688\""));
    }

    #[test]
    fn without_airspeed_a_receiver_and_what_was_learned_are_needed() {
        let says = |more: &str| {
            let unit = "[[sensor]]\nkind = \"icm42688\"\n";
            let text = format!("actuator = []\n[navigation]\nmethod = \"kalman\"\n{unit}{more}");
            let mut remarks = Config::parse(&text, "f")
                .unwrap()
                .remarks(&text)
                .into_iter();
            let found = remarks.find_map(|remark| {
                let (_, lacks) = remark.split_once("airspeed, and there is ")?;
                lacks
                    .split_once(" to fly")
                    .map(|(lacks, _)| lacks.to_owned())
            });
            found.unwrap_or_default()
        };
        let receiver = "[[sensor]]\nkind = \"gpsd\"\n";
        let learned = "[autopilot.airframe]\naxial_offset = 0.0\nfull_thrust_ratio = 0.25\n\
                       zero_lift_angle_deg = -2.0\none_g_angle_deg = 4.0\n";
        let neither = "neither a satellite receiver nor [autopilot.airframe]";
        for (more, lacks) in [
            (String::new(), neither),
            (receiver.to_owned(), "no [autopilot.airframe]"),
            (learned.to_owned(), "no satellite receiver"),
            (format!("{receiver}{learned}"), ""),
            ("[[sensor]]\nkind = \"sdp3x\"\n".to_owned(), ""),
        ] {
            assert_eq!(says(&more), lacks, "{more}");
        }
    }

    #[test]
    fn what_cannot_be_is_refused_with_the_range() {
        assert_eq!(
            parsed("year = 2012.4").unwrap_err(),
            "f:2: navigation.year: is 2012.4: choose 2020 to 2029.999"
        );
    }
}
