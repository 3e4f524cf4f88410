//! `[built-in.calibration]`: from what a sensor gives to what is measured.

use std::time::Duration;

use fcc_calibration::{Axes, AxesCalibration, Calibration, Mounting, Rotation, ScalarCalibration};
use fcc_core::flight::orientation::EulerAngles;
use serde::{Deserialize, Serialize};

/// The calibration of the raw readings of one sensor.
#[derive(Clone, Copy, PartialEq, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct CalibrationSection {
    /// The accelerometer's.
    pub accelerometer: AccelerometerSection,
    /// The gyroscope's.
    pub gyroscope: GyroscopeSection,
    /// The magnetometer's.
    pub magnetometer: MagnetometerSection,
    /// The barometer's.
    pub static_pressure: PressureSection,
    /// That of the airspeed's sensor.
    pub differential_pressure: PressureSection,
    /// The thermometer's.
    pub air_temperature: TemperatureSection,
    /// That of the distance to the ground.
    pub range: RangeSection,
    /// That of satellite navigation.
    pub gnss: GnssSection,
}

/// A section for a sensor of three axes; its bias has a unit.
macro_rules! axes_section {
    ($(#[$doc:meta])* $name:ident, $bias:ident, $si:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            /// Where the sensor's axes point.
            #[serde(with = "super::as_text")]
            pub mounting: Mounting,
            /// How it is turned from there: roll, pitch and yaw.
            #[serde(deserialize_with = "super::exactly::numbers")]
            pub rotation_deg: [f64; 3],
            /// What it gives where there is nothing.
            #[serde(deserialize_with = "super::exactly::numbers")]
            pub $bias: [f64; 3],
            /// The true value of each axis over what it gives.
            #[serde(deserialize_with = "super::exactly::numbers")]
            pub scale: [f64; 3],
            /// How much of an axis belongs to another one.
            #[serde(deserialize_with = "super::exactly::numbers")]
            pub misalignment: [f64; 6],
            /// From the measured event to its arrival.
            pub delay_ms: f64,
        }

        impl Default for $name {
            fn default() -> Self {
                Self {
                    mounting: Mounting::default(),
                    rotation_deg: [0.0; 3],
                    $bias: [0.0; 3],
                    scale: [1.0; 3],
                    misalignment: [0.0; 6],
                    delay_ms: 0.0,
                }
            }
        }

        impl From<&$name> for Axes {
            fn from(section: &$name) -> Self {
                let [roll_rad, pitch_rad, heading_rad] =
                    section.rotation_deg.map(f64::to_radians);
                Self {
                    mounting: section.mounting,
                    rotation: Rotation::of_angles(EulerAngles {
                        roll_rad,
                        pitch_rad,
                        heading_rad,
                    }),
                    bias: section.$bias.map($si),
                    scale: section.scale,
                    misalignment: section.misalignment,
                    delay: from_ms(section.delay_ms),
                }
            }
        }

        impl From<&$name> for AxesCalibration {
            fn from(section: &$name) -> Self {
                Self::new(&section.into())
            }
        }
    };
}

axes_section!(
    /// `[….calibration.accelerometer]`.
    AccelerometerSection,
    bias_mps2,
    |mps2: f64| mps2
);
axes_section!(
    /// `[….calibration.gyroscope]`.
    GyroscopeSection,
    bias_degps,
    f64::to_radians
);
axes_section!(
    /// `[….calibration.magnetometer]`: bias and scale are also the hard and the
    /// soft iron.
    MagnetometerSection,
    bias_ut,
    |ut: f64| ut
);

/// A section for a sensor of one number.
macro_rules! scalar_section {
    ($(#[$doc:meta])* $name:ident, $bias:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Debug, Deserialize, Serialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            /// What it gives where there is nothing.
            pub $bias: f64,
            /// The true value over what it gives.
            pub scale: f64,
            /// From the measured event to its arrival.
            pub delay_ms: f64,
        }

        impl Default for $name {
            fn default() -> Self {
                Self {
                    $bias: 0.0,
                    scale: 1.0,
                    delay_ms: 0.0,
                }
            }
        }

        impl From<&$name> for ScalarCalibration {
            fn from(section: &$name) -> Self {
                Self {
                    bias: section.$bias,
                    scale: section.scale,
                    delay: from_ms(section.delay_ms),
                }
            }
        }
    };
}

scalar_section!(
    /// `[….calibration.static_pressure]` and `differential_pressure`.
    PressureSection,
    bias_pa
);
scalar_section!(
    /// `[….calibration.air_temperature]`.
    TemperatureSection,
    bias_k
);
scalar_section!(
    /// `[….calibration.range]`.
    RangeSection,
    bias_m
);

/// `[….calibration.gnss]`.
#[derive(Clone, Copy, PartialEq, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct GnssSection {
    /// How late a fix arrives.
    pub delay_ms: f64,
}

/// Key, smallest and largest value, as in the table of all keys.
macro_rules! axes_ranges {
    ($sensor:literal, $bias:literal, $most:literal) => {
        &[
            (
                concat!("built-in.calibration.", $sensor, ".rotation_deg"),
                -180.0,
                180.0,
            ),
            (
                concat!("built-in.calibration.", $sensor, ".", $bias),
                -$most,
                $most,
            ),
            (
                concat!("built-in.calibration.", $sensor, ".scale"),
                0.5,
                2.0,
            ),
            (
                concat!("built-in.calibration.", $sensor, ".misalignment"),
                -0.5,
                0.5,
            ),
            (
                concat!("built-in.calibration.", $sensor, ".delay_ms"),
                0.0,
                1_000.0,
            ),
        ]
    };
}

macro_rules! scalar_ranges {
    ($sensor:literal, $bias:literal, $most:literal) => {
        &[
            (concat!($sensor, ".", $bias), -$most, $most),
            (concat!($sensor, ".scale"), 0.5, 2.0),
            (concat!($sensor, ".delay_ms"), 0.0, 1_000.0),
        ]
    };
}

pub(super) const RANGES: &[&[(&str, f64, f64)]] = &[
    axes_ranges!("accelerometer", "bias_mps2", 5.0),
    axes_ranges!("gyroscope", "bias_degps", 50.0),
    axes_ranges!("magnetometer", "bias_ut", 500.0),
    scalar_ranges!("built-in.calibration.static_pressure", "bias_pa", 2_000.0),
    scalar_ranges!(
        "built-in.calibration.differential_pressure",
        "bias_pa",
        500.0
    ),
    scalar_ranges!("built-in.calibration.air_temperature", "bias_k", 50.0),
    scalar_ranges!("built-in.calibration.range", "bias_m", 10.0),
    scalar_ranges!("servo-board.differential_pressure", "bias_pa", 1_000.0),
    &[("built-in.calibration.gnss.delay_ms", 0.0, 1_000.0)],
];

impl CalibrationSection {
    /// The delays of the sensors that navigation uses, by their names.
    pub(super) const fn delays_of_navigation(&self) -> [(&'static str, f64); 6] {
        [
            ("accelerometer", self.accelerometer.delay_ms),
            ("gyroscope", self.gyroscope.delay_ms),
            ("magnetometer", self.magnetometer.delay_ms),
            ("static_pressure", self.static_pressure.delay_ms),
            ("differential_pressure", self.differential_pressure.delay_ms),
            ("gnss", self.gnss.delay_ms),
        ]
    }

    /// Whether it changes nothing.
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The core's calibration; none if it changes nothing.
    pub fn to_core(&self) -> Option<Calibration> {
        let calibration = Calibration {
            accelerometer: (&self.accelerometer).into(),
            gyroscope: (&self.gyroscope).into(),
            magnetometer: (&self.magnetometer).into(),
            static_pressure: (&self.static_pressure).into(),
            differential_pressure: (&self.differential_pressure).into(),
            air_temperature: (&self.air_temperature).into(),
            range: (&self.range).into(),
            gnss_delay: from_ms(self.gnss.delay_ms),
        };
        (!self.is_default()).then_some(calibration)
    }
}

/// Nothing for what is no delay: the table of ranges refuses it.
fn from_ms(ms: f64) -> Duration {
    Duration::try_from_secs_f64(ms * 1e-3).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use crate::config::Config;

    const CALIBRATED: &str = "[built-in.calibration.gyroscope]\n\
         mounting = \"right-backward-down\"\n\
         bias_degps = [1.0, 0.0, 0.0]\n\
         delay_ms = 4\n";

    #[test]
    fn the_units_of_the_file_become_those_of_the_core() {
        let config = Config::parse(CALIBRATED, "test").unwrap();
        let calibration = config
            .built_in
            .clone()
            .unwrap()
            .calibration
            .to_core()
            .unwrap();
        let given = [1.0_f64.to_radians() + 0.2, 0.0, 0.0];
        let [roll, pitch, yaw] = calibration.gyroscope.applied(given);
        assert!(roll.abs() < 1e-12 && (pitch - 0.2).abs() < 1e-12 && yaw == 0.0);
        // What is flown is in the recording.
        let written = config.to_toml().unwrap();
        let again = Config::parse(&written, "again").unwrap();
        assert_eq!(
            again.built_in.unwrap().calibration.to_core(),
            Some(calibration)
        );
        let without = Config::parse("[built-in]\n", "test").unwrap();
        assert_eq!(without.built_in.unwrap().calibration.to_core(), None);
    }

    #[test]
    fn an_error_is_reported_with_its_line_and_what_to_do() {
        for (from, to, expected) in [
            (
                "right-backward-down",
                "right-backward-up",
                "test:2: built-in.calibration.gyroscope.mounting: is left-handed",
            ),
            (
                "[1.0, 0.0, 0.0]",
                "[1.0, 0.0, 1e3]",
                "test:3: built-in.calibration.gyroscope.bias_degps[2]: is 1000: choose -50 to 50",
            ),
            (
                "[1.0, 0.0, 0.0]",
                "[1.0, 0.0]",
                "test:3: built-in.calibration.gyroscope.bias_degps",
            ),
            (
                "= 4",
                "= -4",
                "test:4: built-in.calibration.gyroscope.delay_ms: is -4: choose 0",
            ),
        ] {
            let error = Config::parse(&CALIBRATED.replace(from, to), "test");
            let message = error.unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }
}
