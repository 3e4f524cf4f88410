//! Puts sensors, autopilot and actuators together as a configuration says.

use std::io::ErrorKind;

use fcc_core::flight::{Autopilot, Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor};
use fcc_runtime::LoopConfig;
use fcc_sim::{SimConfig, SimError, Simulation};
use fcc_xplane::{OpenError, XPlane, XPlaneConfig, XPlaneStatus};

use super::restart::RestartRequest;
use super::truth_recorder::{TruthReceiver, tap};
use crate::config::{Aircraft, Config, TelemetrySection, WatchdogSection, XPlaneSection};

/// A flight that is put together and lacks only its clock.
pub struct Assembly {
    /// Sampled in this order.
    pub sensors: Vec<Box<dyn Sensor<Measurements>>>,
    /// Navigation, guidance and control.
    pub autopilot: Autopilot,
    /// Driven in this order.
    pub actuators: Vec<Box<dyn Actuator<Surfaces>>>,
    /// What the loop is told.
    pub loop_config: LoopConfig,
    /// When the loop hangs.
    pub(super) watchdog: WatchdogSection,
    /// Who may watch, live.
    pub(super) telemetry: TelemetrySection,
    /// How it is to be taken up if it is cut off; not with an aircraft that
    /// ends when the program does.
    pub(super) restart: Option<RestartRequest>,
    /// What is true of a simulated aircraft, tick by tick; none where only
    /// sensors tell.
    pub(super) truth: Option<TruthReceiver>,
    /// X-Plane, if it is that.
    pub(super) x_plane: Option<(XPlaneStatus, XPlaneSection)>,
}

/// Why a flight could not be put together.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum AssemblyError {
    /// The built-in aircraft is impossible.
    #[error("the built-in aircraft: {0}")]
    BuiltIn(#[from] SimError),
    /// The connection to X-Plane could not be opened.
    #[error("X-Plane: {0}")]
    XPlane(#[from] OpenError),
}

impl AssemblyError {
    /// Whether another program has the local port.
    pub fn is_taken(&self) -> bool {
        matches!(self, Self::XPlane(OpenError::Bind { source, .. }) if source.kind() == ErrorKind::AddrInUse)
    }
}

/// Puts a flight together.
///
/// # Errors
/// When the aircraft cannot be had.
pub fn assemble(config: &Config) -> Result<Assembly, AssemblyError> {
    let autopilot = Autopilot::new(config.autopilot_config());
    let loop_config = config.loop_config();
    match config.aircraft() {
        Aircraft::BuiltIn(section) => {
            let simulation = Simulation::new(&SimConfig::from(section))?;
            let (sensor, truth) = tap(simulation.sensor, loop_config.messages_capacity);
            Ok(Assembly {
                sensors: vec![Box::new(sensor)],
                autopilot,
                actuators: vec![Box::new(simulation.actuator)],
                loop_config,
                watchdog: config.watchdog.clone(),
                telemetry: config.telemetry.clone(),
                restart: None,
                truth: Some(truth),
                x_plane: None,
            })
        }
        Aircraft::XPlane(section) => {
            let (sensor, actuator) = XPlane::open(&XPlaneConfig::from(section))?;
            let status = sensor.status();
            Ok(Assembly {
                sensors: vec![Box::new(sensor)],
                autopilot,
                actuators: vec![Box::new(actuator)],
                loop_config,
                watchdog: config.watchdog.clone(),
                telemetry: config.telemetry.clone(),
                restart: Some(RestartRequest::of(config)),
                truth: None,
                x_plane: Some((status, section.clone())),
            })
        }
    }
}
