//! Assembles sensors, autopilot and actuators from a configuration.

use std::sync::Arc;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, ControlAuthority, Sensor};
use fcc_fixed_wing::Autopilot;
#[cfg(feature = "live")]
use fcc_live::{SentCommands, StartPublisher};
use fcc_runtime::LoopConfig;
use fcc_sim::{SimConfig, Simulation, TruthHandle};
use fcc_xplane::{XPlane, XPlaneAuthority, XPlaneConfig, XPlaneStatus};

use super::assembly_error::AssemblyError;
use super::calibrated::calibrated;
use super::control_override::ControlOverride;
use super::device::{DeviceReporter, WatchedDevice, open_device};
use super::event_log::EventLog;
#[cfg(feature = "live")]
use super::limits::setpoint_limits;
use super::line_watch::LineWatch;
#[cfg(feature = "live")]
use super::live::{FlightPlans, Live};
use super::observer::Observer;
#[cfg(feature = "live")]
use super::other_users::CommandSocket;
use super::phone::PhoneHost;
use super::plan::Pace;
use super::recording::{FlightRecorder, RecordingRequest};
use super::restart::{RestartKeeper, RestartRequest};
use super::scorer::Scorer;
use super::servos::{servo_authority, servos};
use super::truth_recorder::{TruthReceiver, tap};
use crate::config::{
    ActuatorEntry, Aircraft, BuiltInSection, Config, SensorEntry, WatchdogSection, XPlaneSection,
};

/// An assembled flight, complete except for its clock.
pub struct Assembly {
    /// Sampled in this order, which is that of preference.
    pub sensors: Vec<Box<dyn Sensor<Measurements>>>,
    /// Navigation, guidance and control: not on the stack of the first thread, which stays in
    /// memory.
    pub autopilot: Box<Autopilot>,
    /// Replaces the autopilot's outputs; none in flight.
    pub control: Option<Box<dyn ControlOverride>>,
    /// Driven in this order.
    pub actuators: Vec<Box<dyn Actuator<Surfaces>>>,
    /// The loop's configuration.
    pub loop_config: LoopConfig,
    /// When the loop counts as hung.
    pub(super) watchdog: WatchdogSection,
    /// How it is recovered after an interruption; none for an aircraft that
    /// ends with the program.
    pub(super) restart: Option<RestartRequest>,
    /// The truth of a simulated aircraft, tick by tick; none if there is only
    /// sensor data.
    pub(super) truth: Option<TruthReceiver>,
    /// The present truth of a simulated aircraft.
    pub true_now: Option<TruthHandle>,
    /// The state of the board's devices.
    pub(super) devices: Vec<WatchedDevice>,
    /// The link to a servo board.
    pub(super) line: Option<LineWatch>,
    /// Who has control of it; none for an aircraft that ends with the program.
    pub(super) authority: Option<Arc<dyn ControlAuthority>>,
    /// Starts the process that publishes live telemetry; without it, a thread of
    /// this process does, which other programs of the user can end.
    #[cfg(feature = "live")]
    pub publisher: Option<StartPublisher>,
}

/// A simulated plant: its sensors and actuators.
#[derive(Default)]
struct Plant {
    sensors: Vec<Box<dyn Sensor<Measurements>>>,
    actuators: Vec<Box<dyn Actuator<Surfaces>>>,
    truth: Option<TruthReceiver>,
    true_now: Option<TruthHandle>,
    authority: Option<Arc<dyn ControlAuthority>>,
    x_plane: Option<XPlaneStatus>,
    line: Option<LineWatch>,
}

/// Assembles a flight.
///
/// # Errors
/// When the aircraft or a sensor cannot be created.
pub fn assemble(config: &Config) -> Result<Assembly, AssemblyError> {
    assemble_with(config, None)
}

/// Assembles a flight in a program that runs on a phone, and can read its sensors.
///
/// # Errors
/// As [`assemble`].
pub fn assemble_on_phone(
    config: &Config,
    phone: &mut dyn PhoneHost,
) -> Result<Assembly, AssemblyError> {
    assemble_with(config, Some(phone))
}

fn assemble_with(
    config: &Config,
    mut phone: Option<&mut dyn PhoneHost>,
) -> Result<Assembly, AssemblyError> {
    let loop_config = config.loop_config();
    let mut plant = match config.aircraft() {
        Some(Aircraft::BuiltIn(section)) => {
            let simulated = SimConfig {
                terrain: config.terrain.loaded.unwrap_or_default(),
                ..section.simulation(config.navigation.method)
            };
            built_in(section, &simulated, loop_config.messages_capacity)?
        }
        Some(Aircraft::XPlane(section)) => x_plane(section, config)?,
        None => Plant::default(),
    };
    let mut sensors: Vec<Box<dyn Sensor<Measurements>>> = Vec::new();
    let mut devices = Vec::new();
    let mut servo_board = servo_board(config)?;
    for entry in config.sensors() {
        match entry {
            SensorEntry::Simulator(_) => sensors.append(&mut plant.sensors),
            SensorEntry::XPlane(section) => {
                let (sensor, _) = XPlane::open(&x_plane_config(section, config))?;
                sensors.push(Box::new(match &plant.x_plane {
                    Some(flown) => sensor.beside(flown),
                    None => sensor,
                }));
            }
            SensorEntry::ServoBoard(_) => sensors.append(&mut servo_board.sensors),
            SensorEntry::Device(device) => {
                let (sensor, mut watched) = open_device(device, &mut phone)?;
                sensors.push(calibrated(sensor, device.calibration()));
                devices.append(&mut watched);
            }
        }
    }
    let (mut actuators, mut servo_controls) = (Vec::new(), Vec::new());
    // Whether what is moved goes on without this program.
    let mut outlasts = plant.authority.is_some();
    for entry in config.actuators() {
        match entry {
            ActuatorEntry::Simulator(_) => actuators.append(&mut plant.actuators),
            ActuatorEntry::ServoBoard(_) => {
                outlasts |= !servo_board.actuators.is_empty();
                actuators.append(&mut servo_board.actuators);
            }
            ActuatorEntry::Servos(section) => {
                let opened = servos(section)?;
                actuators.push(opened.actuator);
                devices.push(opened.device);
                servo_controls.push(opened.control);
            }
        }
    }
    Ok(Assembly {
        sensors,
        autopilot: Box::new(Autopilot::new(config.autopilot_config())),
        control: None,
        actuators,
        loop_config,
        watchdog: config.watchdog.clone(),
        restart: outlasts.then(|| RestartRequest::of(config)),
        truth: plant.truth,
        true_now: plant.true_now,
        devices,
        line: servo_board.line,
        // One plant is released after the program: a simulator's.
        authority: plant
            .authority
            .or_else(|| servo_authority(config, servo_controls)),
        #[cfg(feature = "live")]
        publisher: None,
    })
}

fn built_in(
    section: &BuiltInSection,
    simulated: &SimConfig,
    ticks: usize,
) -> Result<Plant, AssemblyError> {
    let simulation = Simulation::new(simulated)?;
    let (sensor, truth) = tap(simulation.sensor, ticks);
    Ok(Plant {
        sensors: vec![calibrated(Box::new(sensor), Some(&section.calibration))],
        actuators: vec![Box::new(simulation.actuator)],
        truth: Some(truth),
        true_now: Some(simulation.truth),
        ..Plant::default()
    })
}

/// The configuration of a connection in a flight: what it reads depends on what
/// is used.
fn x_plane_config(section: &XPlaneSection, config: &Config) -> XPlaneConfig {
    XPlaneConfig {
        pilot_controls: config.engage.stick_takeover.is_some(),
        ..XPlaneConfig::from(section)
    }
}

fn x_plane(section: &XPlaneSection, config: &Config) -> Result<Plant, AssemblyError> {
    let config = x_plane_config(section, config);
    let (sensor, actuator) = XPlane::open(&config)?;
    let status = sensor.status();
    let authority = XPlaneAuthority::of(status.clone(), &config);
    Ok(Plant {
        sensors: vec![Box::new(sensor)],
        actuators: vec![Box::new(actuator)],
        authority: Some(Arc::new(authority)),
        x_plane: Some(status),
        ..Plant::default()
    })
}

/// The servo board's sensor and actuator, if there is one.
fn servo_board(config: &Config) -> Result<Plant, AssemblyError> {
    let Some(section) = &config.servo_board else {
        return Ok(Plant::default());
    };
    let link = section.to_link(config.realtime.priority);
    let (sensor, actuator, status) = fcc_servo_link::open(&link)?;
    Ok(Plant {
        sensors: vec![calibrated(sensor, Some(&section.calibration()))],
        actuators: vec![actuator],
        line: Some(LineWatch::new(status)),
        ..Plant::default()
    })
}

/// Who has control of a configuration's plant, for a program that only releases
/// what another one held; none if nothing can be left held.
pub fn authority_without_connection(config: &Config) -> Option<Arc<dyn ControlAuthority>> {
    match config.aircraft() {
        Some(Aircraft::BuiltIn(_)) | None => servo_authority(config, Vec::new()),
        Some(Aircraft::XPlane(section)) => Some(Arc::new(XPlaneAuthority::without_connection(
            &XPlaneConfig::from(section),
        ))),
    }
}

impl Assembly {
    /// The observers of a flight with this configuration, in any program: the
    /// restart state, the recorder, the score, live telemetry and the event
    /// log. Each once.
    pub fn observers(
        &mut self,
        config: &Config,
        pace: Pace,
        recording: Option<RecordingRequest>,
    ) -> Vec<Box<dyn Observer<Autopilot>>> {
        let mut observers: Vec<Box<dyn Observer<Autopilot>>> = Vec::new();
        if let Some(request) = self.restart.take() {
            observers.push(Box::new(RestartKeeper::new(
                request,
                self.authority.clone(),
            )));
        }
        if let Some(request) = recording {
            observers.push(Box::new(FlightRecorder::<Autopilot>::new(request)));
        }
        let autopilot = self.autopilot.config();
        let guidance = &autopilot.guidance;
        observers.push(Box::new(Scorer::new(guidance, self.truth.take())));
        // In lockstep there is no real time for live telemetry.
        if cfg!(feature = "live") && config.telemetry.enabled && pace == Pace::RealTime {
            #[cfg(feature = "live")]
            observers.push(Box::new(Live::new(
                &config.telemetry,
                &config.tick,
                None,
                SentCommands::new(setpoint_limits(autopilot)),
                self.publisher.take(),
                FlightPlans::new(config),
            )));
            #[cfg(feature = "live")]
            if config.telemetry.commands && config.rights.has_commanders() {
                let socket = CommandSocket::<Autopilot>::new(config, setpoint_limits(autopilot));
                observers.push(Box::new(socket));
            }
        }
        if !self.devices.is_empty() {
            let devices = std::mem::take(&mut self.devices);
            observers.push(Box::new(DeviceReporter::new(devices)));
        }
        if let Some(line) = self.line.take() {
            observers.push(Box::new(line));
        }
        // The last, so that it receives what the others report at their end.
        observers.push(Box::new(EventLog::default()));
        observers
    }
}

#[cfg(test)]
mod tests {
    use std::io::{self, ErrorKind};

    use fcc_xplane::OpenError;

    use super::*;

    #[test]
    fn a_port_that_another_program_has_is_taken() {
        let beacon = |kind: ErrorKind| {
            AssemblyError::XPlane(OpenError::Beacon {
                group: XPlaneConfig::default().beacon,
                source: io::Error::from(kind),
            })
        };
        assert!(beacon(ErrorKind::AddrInUse).is_taken());
        assert!(!beacon(ErrorKind::PermissionDenied).is_taken());
    }

    #[test]
    fn the_pilots_axes_are_read_if_they_can_take_over() {
        for (engage, is_read) in [("", false), ("[engage]\nstick_takeover = 0.3\n", true)] {
            let text = format!("[x-plane]\nengage_switch = \"sim/mine\"\n{engage}");
            let config = Config::parse(&text, "test").unwrap();
            let Some(Aircraft::XPlane(section)) = config.aircraft() else {
                panic!("X-Plane's");
            };
            assert_eq!(x_plane_config(section, &config).pilot_controls, is_read);
            let remarks = config.remarks(&text);
            assert_eq!(remarks.len(), usize::from(is_read));
            let axes = "engage.stick_takeover is 0.3: the pilot's stick takes over, read from \
                        X-Plane's sim/joystick/joy_mapped_axis_value[1] to [3]";
            assert!(remarks.iter().all(|remark| remark.starts_with(axes)));
        }
    }
}
