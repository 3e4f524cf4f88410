//! The configuration file.
//!
//! TOML with units in the key names; unknown keys are refused. Internally
//! everything is SI: each section has a struct in the file's units and a
//! conversion to the core's. Optional keys have defaults; a value out of its
//! range is refused with line, key and range.

mod airframe;
mod altimeter;
mod as_text;
mod autopilot;
mod board;
mod budget;
mod built_in;
mod calibration;
mod calibration_file;
mod contingency;
mod cpu;
mod device;
mod devices;
mod early_wake;
mod entry;
mod error;
mod exactly;
mod gpio;
mod gpsd;
mod ground;
mod guidance;
mod lines;
mod navigation;
mod phone;
mod places;
mod plan;
mod ranges;
mod raw_readings;
mod read;
mod recording;
mod relations;
mod remarks;
mod replacement;
mod restart;
mod rights;
mod runtime;
mod schema;
mod servo_board;
mod servos;
mod shared_devices;
mod similar;
mod start;
mod telemetry;
mod terrain;
mod values;
mod wording;
mod x_plane;

use std::path::Path;
use std::time::Duration;

use fcc_fixed_wing::AutopilotConfig;
use fcc_runtime::{Budget, LoopConfig, Overload};
use fcc_sim::SimConfig;
use fcc_timer::RealtimeRequest;
use serde::{Deserialize, Serialize};

pub use airframe::AirframeSection;
pub use altimeter::AltimeterSection;
pub use autopilot::AutopilotSection;
pub use board::{ChipSection, IioSection};
pub use budget::{BudgetSection, OverloadSection, WatchdogSection};
pub use built_in::{BuiltInSection, GustsChoice, RawSensorsChoice};
pub use calibration::{AccelerometerSection, CalibrationSection};
pub use calibration_file::{CalibrationFileSection, RawSource};
pub use contingency::{ActionChoice, ContingencySection};
pub use cpu::CpuChoice;
pub use device::DeviceEntry;
pub use devices::{ActuatorEntry, NoKeys, SensorEntry};
pub use early_wake::EarlyWakeChoice;
pub use error::{ConfigError, Problem};
pub use gpio::{GpioSwitchSection, HeartbeatSection};
pub use gpsd::GpsdSection;
pub use guidance::GuidanceSection;
pub use lines::{GnssSerialSection, RcReceiverSection};
pub use navigation::{NavigationMethod, NavigationSection};
pub use phone::PhoneSection;
pub use plan::PlanSection;
pub use ranges::range_of;
pub use recording::RecordingSection;
pub(crate) use remarks::NO_ACTUATOR;
pub use replacement::PreparedPlan;
#[cfg(feature = "live")]
pub(crate) use replacement::items_of;
pub use restart::{RestartMode, RestartSection};
pub use rights::RightsSection;
pub use runtime::{
    EarlyWakeSection, EngageSection, FailsafeSection, LoopSection, RealtimeSection, ReleaseSection,
    Then,
};
pub use schema::schema;
pub use servo_board::ServoBoardSection;
pub use servos::{ServoSection, ServosSection};
pub use telemetry::TelemetrySection;
pub use terrain::TerrainSection;
pub use values::keyed;
pub use x_plane::XPlaneSection;

/// A whole configuration file.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Rate and timer.
    #[serde(rename = "loop")]
    pub tick: LoopSection,
    /// What is requested from the kernel.
    pub realtime: RealtimeSection,
    /// How long ticks may take.
    pub budget: BudgetSection,
    /// What is done if ticks leave no time to sleep.
    pub overload: OverloadSection,
    /// When the loop counts as hung.
    pub watchdog: WatchdogSection,
    /// The engage switch.
    pub engage: EngageSection,
    /// What happens when sensors become silent.
    pub failsafe: FailsafeSection,
    /// What precedes a release that can wait.
    pub release: ReleaseSection,
    /// Where flights are recorded.
    pub recording: RecordingSection,
    /// What to do about an interrupted flight.
    pub restart: RestartSection,
    /// With whose rights a flight runs.
    pub rights: RightsSection,
    /// Live telemetry.
    pub telemetry: TelemetrySection,
    /// What `fccd calibrate` found.
    pub calibration: CalibrationFileSection,
    /// Where attitude comes from.
    pub navigation: NavigationSection,
    /// The mode after engaging.
    pub guidance: GuidanceSection,
    /// The flight plan.
    pub plan: PlanSection,
    /// The ground.
    pub terrain: TerrainSection,
    /// What the autopilot does by itself when a flight cannot go on as commanded.
    pub contingency: ContingencySection,
    /// The altimeter setting.
    pub altimeter: AltimeterSection,
    /// Gains and limits.
    pub autopilot: AutopilotSection,
    /// The aircraft is X-Plane's.
    #[serde(rename = "x-plane", skip_serializing_if = "Option::is_none")]
    pub x_plane: Option<XPlaneSection>,
    /// The aircraft is the built-in one.
    #[serde(rename = "built-in", skip_serializing_if = "Option::is_none")]
    pub built_in: Option<BuiltInSection>,
    /// Where the servo board is, for the sensor and the actuator of that kind.
    #[serde(rename = "servo-board", skip_serializing_if = "Option::is_none")]
    pub servo_board: Option<ServoBoardSection>,
    /// Sensors in addition to the simulator's, the most preferred first.
    #[serde(
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "read::apart"
    )]
    pub sensor: Vec<SensorEntry>,
    /// The actuators; the simulator's without a list.
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read::apart"
    )]
    pub actuator: Option<Vec<ActuatorEntry>>,
}

/// All errors, in the order of the text, or the configuration if there are
/// none.
fn checked(read: read::Read<'_>, file: &str) -> Result<Config, ConfigError> {
    let read::Read {
        mut config,
        mut problems,
        places,
    } = read;
    problems.extend(config.plan.content_problems());
    if problems.len() < read::MOST_PROBLEMS {
        problems.extend(ranges::check(&config, &places, &problems));
    }
    problems.sort_by_key(|problem| problem.line);
    if problems.is_empty() {
        return Ok(config);
    }
    if problems.len() >= read::MOST_PROBLEMS {
        problems.truncate(read::MOST_PROBLEMS);
        problems.push(Problem::and_more());
    }
    for problem in &mut problems {
        problem.shorten();
    }
    Err(ConfigError::Invalid {
        file: file.to_owned(),
        problems,
    })
}

/// Which aircraft a configuration flies.
#[derive(Clone, Copy, Debug)]
pub enum Aircraft<'a> {
    /// X-Plane's, over UDP.
    XPlane(&'a XPlaneSection),
    /// The built-in one.
    BuiltIn(&'a BuiltInSection),
}

/// The maximum size of a configuration; the longest in config/ has a hundredth
/// of it.
const MOST_BYTES: u64 = 1_000_000;

/// How long the thread that reads the loop's messages may be delayed before
/// records are lost, at 500 Hz or less.
const FETCHED_WITHIN_S: f64 = 8.0;

impl Config {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// When it cannot be read, is not TOML, has an unknown key or a value out
    /// of range: every problem with its line.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        Self::load_with_text(path).map(|(config, _)| config)
    }

    /// Reads and checks a file, and gives its text as well.
    ///
    /// # Errors
    /// As [`Config::load`].
    pub fn load_with_text(path: &Path) -> Result<(Self, String), ConfigError> {
        let file = path.display().to_string();
        let text = Self::read_text(path)?;
        if fcc_plan::is_plan(&text) {
            return Err(ConfigError::a_plan(file));
        }
        Ok((Self::parse(&text, &file)?, text))
    }

    /// Reads the text of a configuration of any vehicle.
    ///
    /// # Errors
    /// When it is no regular file, too large, cannot be read, or is no text.
    pub fn read_text(path: &Path) -> Result<String, ConfigError> {
        let file = path.display().to_string();
        let bytes = match fcc_record::read_file(path, MOST_BYTES) {
            Ok(bytes) => bytes,
            Err(source) => return Err(ConfigError::Unreadable { file, source }),
        };
        let text = std::str::from_utf8(&bytes)
            .map_err(|error| ConfigError::not_text(&file, &bytes, error))?;
        Ok(text.to_owned())
    }

    /// Checks a text; `file` is its name in messages.
    ///
    /// # Errors
    /// As [`Config::load`], but for reading.
    pub fn parse(text: &str, file: &str) -> Result<Self, ConfigError> {
        checked(read::read(text), file)
    }

    /// Checks a text for programs with their own aircraft: neither `[x-plane]`
    /// nor `[built-in]` is needed.
    ///
    /// # Errors
    /// As [`Config::parse`].
    pub fn parse_without_aircraft(text: &str, file: &str) -> Result<Self, ConfigError> {
        let mut read = read::read(text);
        if read.config.x_plane.is_none() && !read.config.is_without_simulator() {
            read.config.built_in.get_or_insert_default();
        }
        checked(read, file)
    }

    /// The autopilot's part of such a text.
    ///
    /// # Errors
    /// As [`Config::parse`].
    pub fn parse_autopilot(text: &str, file: &str) -> Result<AutopilotConfig, ConfigError> {
        Ok(Self::parse_without_aircraft(text, file)?.autopilot_config())
    }

    /// The core's configuration.
    pub fn autopilot_config(&self) -> AutopilotConfig {
        AutopilotConfig {
            settling: self.restart.mode.settling(),
            max_silence: Duration::from_secs_f64(self.failsafe.all_silent_s),
            permits_upset: self.engage.permit_upset,
            stick_takeover: self.engage.takeover(),
            level_and_trim: Duration::from_secs_f64(self.release.level_and_trim_s),
            failsafe: (&self.failsafe).into(),
            altimeter: (&self.altimeter).into(),
            plan: self.plan.route(),
            prepared: replacement::prepared_routes(),
            route: self.plan.route_config(&self.autopilot.runway),
            contingency: (&self.contingency).into(),
            terrain: self.terrain.loaded.unwrap_or_default(),
            raw_navigation: self.navigation.to_core(self.simulated_field_ut()),
            ..self.autopilot.to_core(
                &self.guidance,
                Duration::from_millis(self.failsafe.sensor_max_age_ms),
                Duration::from_secs_f64(self.failsafe.sensor_frozen_s),
            )
        }
    }

    /// The earth's magnetic field around the built-in aircraft.
    fn simulated_field_ut(&self) -> Option<[f64; 3]> {
        let gives_raw = |section: &&BuiltInSection| section.raw_sensors != RawSensorsChoice::None;
        let section = self.built_in.as_ref().filter(gives_raw)?;
        Some(SimConfig::from(section).magnetic_field_ut())
    }

    /// The loop's configuration.
    pub fn loop_config(&self) -> LoopConfig {
        let most = LoopConfig::default().messages_capacity;
        LoopConfig {
            messages_capacity: self.tick.ticks_in(FETCHED_WITHIN_S, most),
            switch_off: self.engage.switch_off.into(),
            command_needs_switch: self.engage.command_needs_switch,
            failsafe_hold: Duration::from_secs_f64(self.failsafe.hold_s),
            after_failsafe: self.failsafe.then.into(),
            budget: Budget::from(&self.budget),
            overload: Overload::from(&self.overload),
            early_wake_needs_priority: self.tick.early_wake.enabled == EarlyWakeChoice::Auto,
            realtime: RealtimeRequest::from(&self.realtime),
            ..LoopConfig::default()
        }
    }

    /// The aircraft; the built-in one if a program did not choose (a file has
    /// to), none if the lists of sensors and actuators stand alone.
    pub fn aircraft(&self) -> Option<Aircraft<'_>> {
        static DEFAULT: std::sync::LazyLock<BuiltInSection> =
            std::sync::LazyLock::new(BuiltInSection::default);
        match (&self.x_plane, &self.built_in) {
            (Some(section), _) => Some(Aircraft::XPlane(section)),
            (None, Some(section)) => Some(Aircraft::BuiltIn(section)),
            (None, None) if self.is_without_simulator() => None,
            (None, None) => Some(Aircraft::BuiltIn(&DEFAULT)),
        }
    }
}
