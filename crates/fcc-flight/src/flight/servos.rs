//! Servos: the thread that writes to them, and who has control of them.

use std::sync::Arc;

use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ControlAuthority, PlantId};
use fcc_linux::DeviceError;
use fcc_linux::gpio::GpioLine;
use fcc_linux::servo::{
    HeartbeatLine, Pca9685, Pca9685Settings, PulseOutputs, ReleasePulses, ServoAuthority, ServoBus,
    ServoControl, ServoThread, SysfsPwm,
};

use super::assembly_error::AssemblyError;
use super::device::WatchedDevice;
use crate::config::{ActuatorEntry, Config, ServosSection};

const SERVOS: &str = "servos";

/// An actuator of servos, and what is to be known of it.
pub(super) struct Servos {
    pub(super) actuator: Box<dyn Actuator<Surfaces>>,
    pub(super) device: WatchedDevice,
    pub(super) control: ServoControl,
}

/// Starts the thread that writes to servos. Outputs that are not there are no
/// error: they may be, later.
pub(super) fn servos(section: &ServosSection) -> Result<Servos, AssemblyError> {
    let name = format!("{SERVOS} at {}", section.place().display());
    let thread = ServoThread::new(name.clone(), section.to_linux());
    let device = WatchedDevice::new(SERVOS, name.clone(), thread.status());
    let section = section.clone();
    let open = move || {
        let outputs = outputs(&section, Set::Up)?;
        let heartbeat = match &section.heartbeat {
            None => None,
            Some(heartbeat) => {
                let line: Box<dyn HeartbeatLine> = Box::new(GpioLine::output(&heartbeat.pin())?);
                Some(line)
            }
        };
        Ok(ServoBus { outputs, heartbeat })
    };
    let actuator = thread.start(open);
    let actuator = actuator.map_err(|source| AssemblyError::Device { name, source })?;
    Ok(Servos {
        control: actuator.control(),
        actuator: Box::new(actuator),
        device,
    })
}

/// Whether outputs are set up, without a pulse, or go on as another process has
/// set them up.
#[derive(Clone, Copy)]
enum Set {
    Up,
    ByAnother,
}

fn outputs(section: &ServosSection, set: Set) -> Result<Box<dyn PulseOutputs>, DeviceError> {
    let Some(bus) = &section.pca9685 else {
        let outputs = section.pwm_outputs();
        return Ok(Box::new(match set {
            Set::Up => SysfsPwm::open(&outputs, section.rate_hz)?,
            Set::ByAnother => SysfsPwm::of_another_process(&outputs),
        }));
    };
    let settings = Pca9685Settings {
        device: format!("{}, address {:#04x}", bus.display(), section.address),
        address: section.address,
        rate_hz: section.rate_hz,
        oscillator_hz: section.oscillator_mhz * 1e6,
        outputs: section.channels.iter().map(|c| c.output as u8).collect(),
    };
    Ok(Box::new(match set {
        Set::Up => Pca9685::open_at(bus, settings)?,
        Set::ByAnother => Pca9685::of_another_process_at(bus, settings)?,
    }))
}

/// Who has control of a configuration's servos; none if it has none. `controls` is
/// empty in a program that only releases them.
pub(super) fn servo_authority(
    config: &Config,
    controls: Vec<ServoControl>,
) -> Option<Arc<dyn ControlAuthority>> {
    let servos = config.actuators().iter().filter_map(|entry| match entry {
        ActuatorEntry::Servos(section) => Some(section.as_ref()),
        ActuatorEntry::Simulator(_) | ActuatorEntry::ServoBoard(_) => None,
    });
    let sections: Vec<&ServosSection> = servos.collect();
    let first = sections.first()?;
    let named = PlantId::new(format_args!("{SERVOS} at {}", first.place().display()));
    let plant = named.or_else(|| PlantId::new(format_args!("{SERVOS}")))?;
    let releases = sections.into_iter().map(|section| {
        let section = section.clone();
        let pulses = section.to_linux().released_pulses();
        let release: ReleasePulses =
            Box::new(move || outputs(&section, Set::ByAnother)?.write(&pulses));
        release
    });
    Some(Arc::new(ServoAuthority::new(
        plant,
        controls,
        releases.collect(),
    )))
}
