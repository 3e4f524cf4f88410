//! `[calibration]`: what `fccd calibrate` found, and the places that it is for.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{
    BuiltInSection, CalibrationSection, Config, DeviceEntry, RawSensorsChoice, SensorEntry,
    ServoBoardSection,
};

/// `[calibration]`.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct CalibrationFileSection {
    /// Whether what `fccd calibrate` found replaces the same keys of the
    /// configuration.
    pub enabled: bool,
    /// Where it is stored. Default: a file named after the instance, in
    /// systemd's state directory or next to the recordings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// What is older is reported at the start.
    pub stale_after_days: f64,
}

impl Default for CalibrationFileSection {
    fn default() -> Self {
        Self {
            enabled: true,
            file: None,
            stale_after_days: 180.0,
        }
    }
}

/// A source of raw readings that has a calibration.
#[derive(Clone, PartialEq, Debug)]
pub struct RawSource {
    /// Its key in the configuration.
    pub place: String,
    /// Which sensors these are: others have another calibration.
    pub sensor: String,
    /// Its calibration.
    pub calibration: CalibrationSection,
}

impl RawSource {
    /// Whether it is the built-in aircraft.
    pub fn is_built_in(&self) -> bool {
        self.place == BUILT_IN
    }

    /// Whether it is the servo board, whose calibration is that of its pitot tube
    /// alone.
    pub fn is_servo_board(&self) -> bool {
        self.place == SERVO_BOARD
    }

    /// The key of its calibration in the configuration.
    pub fn calibration_key(&self) -> String {
        if self.is_servo_board() {
            return self.place.clone();
        }
        format!("{}.calibration", self.place)
    }
}

impl Config {
    /// A file of this extension, named after the instance, in the state folder:
    /// systemd's, or that of the recordings.
    pub(crate) fn state_file(&self, extension: &str) -> PathBuf {
        let given = std::env::var_os("STATE_DIRECTORY");
        let given = given.and_then(|folders| std::env::split_paths(&folders).next());
        given
            .unwrap_or_else(|| self.recording.folder.clone())
            .join(format!("{}.{extension}", self.telemetry.instance))
    }

    /// Where what `fccd calibrate` found is stored.
    pub fn calibration_file(&self) -> PathBuf {
        let given = self.calibration.file.clone();
        given.unwrap_or_else(|| self.state_file("calibration.toml"))
    }

    /// The sources of raw readings, in their order of preference.
    pub fn raw_sources(&self) -> Vec<RawSource> {
        let built_in = self.built_in.as_ref().and_then(built_in);
        // Those of the list come first.
        let sensors = self.sensors().enumerate();
        let sources = sensors.filter_map(|(at, entry)| {
            if entry.is_simulator() {
                return built_in.clone();
            }
            if matches!(entry, SensorEntry::ServoBoard(_)) {
                return self.servo_board.as_ref().map(servo_board);
            }
            let board = entry.device().filter(|device| device.is_board())?;
            Some(RawSource {
                place: listed(at),
                sensor: board.describe(),
                calibration: *board.calibration()?,
            })
        });
        sources.collect()
    }

    /// The earth's magnetic field, north, east and down, µT: the configured one,
    /// or that around the built-in aircraft.
    pub(crate) fn earth_field_ut(&self) -> Option<[f64; 3]> {
        let given = self.navigation.magnetic_field_ut;
        given.or_else(|| self.simulated_field_ut())
    }

    /// Gives a source another calibration.
    pub(crate) fn set_calibration(&mut self, place: &str, calibration: &CalibrationSection) {
        if place == SERVO_BOARD {
            if let Some(section) = &mut self.servo_board {
                section.differential_pressure = calibration.differential_pressure;
            }
            return;
        }
        let mut entries = self.sensor.iter_mut().enumerate();
        let section = if place == BUILT_IN {
            let section = self.built_in.as_mut();
            section.map(|section| &mut section.calibration)
        } else {
            let entry = entries.find(|(at, _)| listed(*at) == place);
            entry.and_then(|(_, entry)| match entry {
                SensorEntry::Device(device) => device.board_calibration_mut(),
                _ => None,
            })
        };
        if let Some(section) = section {
            *section = *calibration;
        }
    }

    /// The sensor of a board that is the source of this place.
    pub(crate) fn board_sensor_of(&self, place: &str) -> Option<&DeviceEntry> {
        let mut boards = self.devices().filter(|(_, device)| device.is_board());
        let (_, board) = boards.find(|(at, _)| listed(*at) == place)?;
        Some(board)
    }
}

const BUILT_IN: &str = "built-in";
const SERVO_BOARD: &str = "servo-board";

/// The key of an entry of `[[sensor]]`.
fn listed(at: usize) -> String {
    format!("sensor[{at}]")
}

fn servo_board(section: &ServoBoardSection) -> RawSource {
    let at = match (&section.serial, &section.address) {
        (Some(path), _) => path.display().to_string(),
        (None, Some(address)) => address.to_string(),
        (None, None) => String::new(),
    };
    RawSource {
        place: SERVO_BOARD.to_owned(),
        sensor: format!("servo board at {at}"),
        calibration: section.calibration(),
    }
}

fn built_in(section: &BuiltInSection) -> Option<RawSource> {
    let set = match section.raw_sensors {
        RawSensorsChoice::None => return None,
        RawSensorsChoice::Phone => "phone",
        RawSensorsChoice::Board => "board",
    };
    Some(RawSource {
        place: BUILT_IN.to_owned(),
        sensor: format!("simulated {set}, seed {}", section.seed),
        calibration: section.calibration,
    })
}

#[cfg(test)]
mod tests {
    use crate::config::{CalibrationSection, Config};

    const BOARD: &str = "actuator = []\n[navigation]\nmethod = \"kalman\"\n\
         [[sensor]]\nkind = \"icm42688\"\nspi = \"/dev/spidev0.0\"\n\
         [[sensor]]\nkind = \"x-plane\"\n\
         [[sensor]]\nkind = \"qmc5883l\"\ni2c = \"/dev/i2c-2\"\n\
         [[sensor]]\nkind = \"iio\"\ndevice = \"bmp380\"\n";

    #[test]
    fn each_sensor_of_a_board_is_a_source_with_a_calibration_of_its_own() {
        let mut config = Config::parse(BOARD, "test").unwrap();
        let sources = config.raw_sources();
        let found: Vec<_> = sources
            .iter()
            .map(|source| (source.place.as_str(), source.sensor.as_str()))
            .collect();
        assert_eq!(
            found,
            [
                ("sensor[0]", "ICM-42688-P at /dev/spidev0.0"),
                ("sensor[2]", "QMC5883L at /dev/i2c-2 0x0d"),
                ("sensor[3]", "IIO bmp380"),
            ]
        );
        let mut of = CalibrationSection::default();
        of.magnetometer.bias_ut = [1.0, 2.0, 3.0];
        config.set_calibration("sensor[2]", &of);
        config.set_calibration("sensor[1]", &of);
        let biases = config.raw_sources();
        let biases = biases.iter().map(|of| of.calibration.magnetometer.bias_ut);
        assert_eq!(
            biases.collect::<Vec<_>>(),
            [[0.0; 3], [1.0, 2.0, 3.0], [0.0; 3]]
        );
    }

    #[test]
    fn a_servo_board_is_a_source_whose_pitot_tube_is_calibrated() {
        let text = "[servo-board]\nserial = \"/dev/ttyUSB0\"\n[[sensor]]\nkind = \"x-plane\"\n\
                    [[sensor]]\nkind = \"servo-board\"\n[[actuator]]\nkind = \"servo-board\"\n\
                    [servo-board.differential_pressure]\nbias_pa = 2.0\n";
        let mut config = Config::parse(text, "test").unwrap();
        let [source] = &config.raw_sources()[..] else {
            panic!("{:?}", config.raw_sources());
        };
        let found = (source.place.as_str(), source.sensor.as_str());
        assert_eq!(found, ("servo-board", "servo board at /dev/ttyUSB0"));
        let mut of = source.calibration;
        assert_eq!(of.differential_pressure.bias_pa, 2.0);
        of.differential_pressure.bias_pa = -3.5;
        config.set_calibration("servo-board", &of);
        let written = config.to_toml().unwrap();
        assert!(written.contains("bias_pa = -3.5"), "{written}");
    }

    #[test]
    fn a_calibration_of_a_board_is_checked_as_that_of_the_built_in_aircraft() {
        for (keys, expected) in [
            (
                "misalignment = [-0.5, -0.5, -0.5, -0.5, -0.5, -0.5]",
                "sensor[3].calibration.magnetometer.misalignment",
            ),
            (
                "delay_ms = 900",
                "sensor[3].calibration.magnetometer.delay_ms",
            ),
        ] {
            let text = format!("{BOARD}[sensor.calibration.magnetometer]\n{keys}\n");
            let message = Config::parse(&text, "test").unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
