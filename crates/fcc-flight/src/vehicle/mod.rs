//! Vehicles beside the aeroplane: what each declares, and how it is flown and replayed.
//!
//! A vehicle is a controller with a [`Vehicle`]: its name, the keys of its configuration, and
//! how its parts are opened. All else is generic: the loop, the observers, the recording and its
//! replay. A program lists the vehicles that it knows, one line each.

mod ardrone;
mod fly;
mod multicopter;
mod multicopter_plan;
mod multicopter_score;

use std::path::Path;

use fcc_core::framework::{Actuator, Controller, RecordOf, Sensor, Switch};
#[cfg(feature = "live")]
use fcc_live::{Commandable, SentCommands, StartPublisher};
use fcc_record::Recorded;
use fcc_replay::{Chain, Replay};
use fcc_sim::TruthHandle;
use fcc_telemetry::Instance;
use serde::Serialize;
use serde::de::DeserializeOwned;

pub use ardrone::ArDroneKeys;
pub use fly::fly_vehicle;
pub use multicopter::MulticopterFile;

use crate::config::{
    ConfigError, GustsChoice, LoopSection, Problem, RealtimeSection, RecordingSection,
    TelemetrySection,
};
use crate::flight::Observer;
#[cfg(feature = "live")]
use crate::flight::live::Live;
use crate::flight::truth_recorder::TruthReceiver;

/// What a vehicle declares.
pub trait Vehicle: Recorded + Sized {
    /// Its name: of the key `vehicle` of a configuration, of `--vehicle`, of the plant in its
    /// recordings.
    const NAME: &'static str;

    /// The keys of its configuration; `vehicle` is one of them.
    type Config: Clone + Default + Serialize + DeserializeOwned;

    /// The sections that each vehicle has.
    fn sections(config: &Self::Config) -> Sections<'_>;

    /// Applies what a command line says.
    ///
    /// # Errors
    /// What cannot be flown.
    fn apply(config: &mut Self::Config, wishes: &Wishes<'_>) -> Result<(), String>;

    /// Describes a valid configuration.
    ///
    /// # Errors
    /// What cannot be flown.
    fn check(config: &Self::Config) -> Result<String, String>;

    /// Its controller.
    ///
    /// # Errors
    /// Why it cannot be flown as configured.
    fn controller(config: &Self::Config) -> Result<Self, String>;

    /// Opens what is flown.
    ///
    /// # Errors
    /// What cannot be opened.
    fn open(config: &Self::Config) -> Result<Opened<Self>, String>;

    /// Who flies it in real time beside its plan: observers that command.
    ///
    /// # Errors
    /// What cannot be opened.
    fn commanders(_config: &Self::Config) -> Result<Vec<Box<dyn Observer<Self>>>, String> {
        Ok(Vec::new())
    }

    /// Whether the flight is over when it has landed: not if others command it.
    fn ends_at_rest(_config: &Self::Config) -> bool {
        true
    }

    /// Scores a flight by the truth.
    fn scorer(truth: TruthReceiver) -> Box<dyn Observer<Self>>;

    /// What a line a second shows of it.
    fn describe(record: &RecordOf<Self>) -> Option<String>;

    /// Whether the engage switch is read, and its position.
    fn switch_position(record: &RecordOf<Self>) -> Option<Switch>;

    /// Whether it rests: the flight is over if it rests after it has moved.
    fn rests(record: &RecordOf<Self>) -> bool;
}

/// The sections that each vehicle's configuration has.
pub struct Sections<'a> {
    /// Rate and timer.
    pub tick: &'a LoopSection,
    /// What is requested from the kernel.
    pub realtime: &'a RealtimeSection,
    /// Where flights are recorded.
    pub recording: &'a RecordingSection,
    /// Live telemetry.
    pub telemetry: &'a TelemetrySection,
}

/// What a command line says; what is none stays as configured.
#[derive(Clone, Copy, Default, Debug)]
pub struct Wishes<'a> {
    /// Seed of gusts and noise.
    pub seed: Option<u64>,
    /// Strength of the gusts.
    pub gusts: Option<GustsChoice>,
    /// The file of a plan.
    pub plan: Option<&'a Path>,
    /// The folder of recordings.
    pub recordings: Option<&'a Path>,
    /// Whether nothing is recorded.
    pub not_recorded: bool,
    /// The name under which it is published.
    pub instance: Option<&'a Instance>,
}

/// The parts of a vehicle that a loop samples and drives.
pub struct Opened<V: Controller> {
    /// Sampled in this order.
    pub sensors: Vec<Box<dyn Sensor<V::Measurements>>>,
    /// Driven in this order.
    pub actuators: Vec<Box<dyn Actuator<V::Outputs>>>,
    /// The truth, tick by tick.
    pub truth: TruthReceiver,
    /// The present truth.
    pub true_now: TruthHandle,
}

/// Publishes a flight in real time, by the process that `process` starts, and takes commands for
/// it; none if its configuration does not want that.
#[cfg(feature = "live")]
pub fn live_vehicle<V: Vehicle + Commandable>(
    config: &V::Config,
    process: StartPublisher,
) -> Option<Box<dyn Observer<V>>> {
    let Sections {
        telemetry, tick, ..
    } = V::sections(config);
    let commands = SentCommands::new(Vec::new());
    let live = Live::new(telemetry, tick, Some(V::NAME), commands, Some(process), ());
    telemetry.enabled.then(|| Box::new(live) as _)
}

/// The name of the vehicle in a configuration; none if it is an aeroplane's.
pub fn vehicle_in(text: &str) -> Option<String> {
    let table: toml::Table = toml::from_str(text).ok()?;
    Some(table.get("vehicle")?.as_str()?.to_owned())
}

/// Reads a vehicle's configuration; `file` is its name in messages.
///
/// # Errors
/// The first problem, with its line.
pub fn parse<V: Vehicle>(text: &str, file: &str) -> Result<V::Config, ConfigError> {
    let invalid = |line, message: String| ConfigError::Invalid {
        file: file.to_owned(),
        problems: vec![Problem {
            line,
            key: None,
            message,
        }],
    };
    let config: V::Config = toml::from_str(text).map_err(|error| {
        let before = error.span().and_then(|span| text.get(..span.start));
        let line = before.map(|before| before.matches('\n').count() + 1);
        invalid(line, error.message().replace('\n', " "))
    })?;
    V::check(&config).map_err(|problem| invalid(None, problem))?;
    Ok(config)
}

/// A replay of a vehicle's recording, by the configuration in it.
///
/// # Errors
/// When this version cannot read or fly it.
pub fn replay_vehicle<V: Vehicle>(chain: &Chain) -> Result<Replay<V>, String> {
    let config = parse::<V>(&chain.about().config, &chain.config_name())
        .map_err(|error| error.to_string())?;
    let controller = V::controller(&config)?;
    let sections = V::sections(&config);
    Replay::new(
        controller,
        sections.tick.period(),
        &fly::loop_config(&sections),
    )
    .map_err(|error| error.to_string())
}
