//! `[calibration]`: what `fccd calibrate` found, and the places that it is for.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{BoardSensor, BuiltInSection, CalibrationSection, Config, RawSensorsChoice};

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
pub struct RawSource<'a> {
    /// Its key, to which `.calibration` belongs.
    pub place: String,
    /// Which sensors these are: others have another calibration.
    pub sensor: String,
    /// Its calibration.
    pub calibration: &'a CalibrationSection,
}

impl RawSource<'_> {
    /// Whether it is the built-in aircraft.
    pub fn is_built_in(&self) -> bool {
        self.place == BUILT_IN
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
    pub fn raw_sources(&self) -> Vec<RawSource<'_>> {
        let built_in = self.built_in.as_ref().and_then(built_in);
        // Those of the list come first.
        let sensors = self.sensors().enumerate();
        let sources = sensors.filter_map(|(at, entry)| {
            if entry.is_simulator() {
                return built_in.clone();
            }
            let board = entry.board()?;
            Some(RawSource {
                place: listed(at),
                sensor: board.describe(),
                calibration: board.calibration(),
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

    /// The calibration of a source.
    pub(crate) fn calibration_of(&mut self, place: &str) -> Option<&mut CalibrationSection> {
        if place == BUILT_IN {
            return self
                .built_in
                .as_mut()
                .map(|section| &mut section.calibration);
        }
        let mut entries = self.sensor.iter_mut().enumerate();
        let (_, entry) = entries.find(|(at, _)| listed(*at) == place)?;
        entry.calibration_mut()
    }

    /// The sensor of a board that is the source of this place.
    pub(crate) fn board_sensor_of(&self, place: &str) -> Option<BoardSensor<'_>> {
        let mut entries = self.sensor.iter().enumerate();
        let (_, entry) = entries.find(|(at, _)| listed(*at) == place)?;
        entry.board()
    }
}

const BUILT_IN: &str = "built-in";

/// The key of an entry of `[[sensor]]`.
fn listed(at: usize) -> String {
    format!("sensor[{at}]")
}

fn built_in(section: &BuiltInSection) -> Option<RawSource<'_>> {
    let set = match section.raw_sensors {
        RawSensorsChoice::None => return None,
        RawSensorsChoice::Phone => "phone",
        RawSensorsChoice::Board => "board",
    };
    Some(RawSource {
        place: BUILT_IN.to_owned(),
        sensor: format!("simulated {set}, seed {}", section.seed),
        calibration: &section.calibration,
    })
}
