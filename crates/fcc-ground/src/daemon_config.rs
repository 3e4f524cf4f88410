//! The configurations of the daemons: what their plans are checked for.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fcc_fixed_wing::Autopilot;
use fcc_flight::config::{BuiltInSection, Config, ConfigError};
use fcc_flight::flight::setpoint_limits;
use fcc_live::Commandable as _;
use fcc_telemetry::Instance;
use serde_json::{Value, json};

/// The configuration of each daemon, by its name; the built-in aircraft's for others.
#[derive(Debug)]
pub(crate) struct DaemonConfigs {
    by_instance: BTreeMap<Instance, (PathBuf, Config)>,
    other: Config,
    first: Option<Instance>,
    /// The folder of recordings of the first.
    pub(crate) recordings: Option<PathBuf>,
}

impl DaemonConfigs {
    pub(crate) fn load(files: &[PathBuf]) -> Result<Self, ConfigError> {
        let mut by_instance = BTreeMap::new();
        let (mut first, mut recordings) = (None, None);
        for file in files {
            let config = Config::load(file)?;
            let instance = config.telemetry.instance.clone();
            recordings.get_or_insert_with(|| config.recording.folder.clone());
            first.get_or_insert_with(|| instance.clone());
            by_instance.insert(instance, (file.clone(), config));
        }
        let other = Config {
            built_in: Some(BuiltInSection::default()),
            ..Config::default()
        };
        Ok(Self {
            by_instance,
            other,
            first,
            recordings,
        })
    }

    pub(crate) fn of(&self, instance: Option<&Instance>) -> &Config {
        let known = match instance {
            Some(instance) => self.by_instance.get(instance),
            None => self.by_instance.values().next(),
        };
        known.map_or(&self.other, |(_, config)| config)
    }

    /// The configuration's file.
    pub(crate) fn file(&self, instance: &Instance) -> Option<&Path> {
        self.by_instance
            .get(instance)
            .map(|(file, _)| file.as_path())
    }

    /// The name of the daemon of the first configuration.
    pub(crate) const fn first(&self) -> Option<&Instance> {
        self.first.as_ref()
    }

    /// The names of the daemons.
    pub(crate) fn instances(&self) -> impl Iterator<Item = &Instance> {
        self.by_instance.keys()
    }

    /// The file that this daemon reads its plan from when it starts.
    pub(crate) fn plan_file(&self, instance: &Instance) -> Option<&Path> {
        self.by_instance.get(instance)?.1.plan.file.as_deref()
    }
}

/// The set points that may be commanded, with their limits for this aircraft.
pub(crate) fn setpoints(config: &Config) -> Value {
    let own = setpoint_limits(&config.autopilot_config());
    let single = Autopilot::SETPOINTS.iter().filter_map(|known| {
        let limits = match own.iter().find(|(name, _)| *name == known.name) {
            Some((_, Err(_))) => return None,
            Some((_, Ok(limits))) => limits.clone(),
            None => known.limits.clone(),
        };
        Some((known.name, limits))
    });
    let joint = Autopilot::JOINT
        .iter()
        .flat_map(|joint| joint.parts.iter().cloned());
    let all = single.chain(joint).map(|(name, limits)| {
        json!({
            "name": name,
            "unit": unit(name),
            "lowest": limits.start(),
            "highest": limits.end(),
        })
    });
    all.collect()
}

/// The unit at the end of a set point's name.
fn unit(name: &str) -> &'static str {
    match name.rsplit('_').next() {
        Some("mps") => "m/s",
        Some("rad") => "rad",
        Some("m") => "m",
        Some("pa") => "Pa",
        Some("s") => "s",
        _ => "",
    }
}

/// The limits of the aircraft.
pub(crate) fn aircraft(config: &Config) -> Value {
    let autopilot = config.autopilot_config();
    let airspeeds = autopilot.envelope.allowed_airspeeds();
    let conditions = config.plan_conditions();
    json!({
        "stall_mps": autopilot.envelope.stall_airspeed_mps,
        "min_mps": airspeeds.start(),
        "max_mps": airspeeds.end(),
        "never_exceed_mps": autopilot.envelope.never_exceed_airspeed_mps,
        "best_glide_mps": autopilot.envelope.best_glide_airspeed_mps,
        "max_bank_rad": conditions.bank_rad,
        "max_climb_mps": conditions.climb_mps,
        "max_sink_mps": conditions.descent_mps,
    })
}
