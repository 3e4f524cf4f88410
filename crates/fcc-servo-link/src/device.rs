//! The servo board as a sensor and an actuator.

use core::time::Duration;
use std::io;
use std::path::{Path, PathBuf};

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, ActuatorFault, Sensor, SensorFault, Tick};
use fcc_xplane::{Port, Simulator, UdpPort, XPlane, XPlaneActuator, XPlaneSensor, XPlaneStatus};

use crate::config::{Link, ServoBoardConfig};
use crate::line::LineStatus;
use crate::serial_port::{BOARD, SerialPort};
use crate::tty::Baud;

const NAME: &str = "servo board";

/// Why a servo board could not be opened.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum OpenError {
    /// The serial line.
    #[error("cannot open {}: {source}; {}", path.display(), advice(source))]
    Line {
        /// The device.
        path: PathBuf,
        /// The operating system's error.
        source: io::Error,
    },
    /// The socket, or the configuration.
    #[error(transparent)]
    Messages(#[from] fcc_xplane::OpenError),
}

fn advice(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => {
            "plug the board in, or choose another serial (ls /dev/serial/by-id)"
        }
        io::ErrorKind::PermissionDenied => {
            "add the user to the group of the device, usually dialout"
        }
        io::ErrorKind::ResourceBusy => "another program has it: end that one",
        _ => "choose a serial line, such as /dev/ttyUSB0",
    }
}

/// The board as a sensor: airspeed or differential pressure, the engage switch,
/// and where the servos are.
#[derive(Debug)]
pub struct ServoBoardSensor<P: Port> {
    messages: XPlaneSensor<P>,
    line: Option<LineStatus>,
    /// How many frames were corrupt, and how often too much arrived, at the last tick.
    corrupt: u64,
}

impl<P: Port> ServoBoardSensor<P> {
    fn status(&self) -> LinkStatus {
        LinkStatus {
            line: self.line.clone(),
            messages: self.messages.status(),
        }
    }
}

/// The board as an actuator: elevator, aileron, rudder and throttle.
#[derive(Debug)]
pub struct ServoBoardActuator<P: Port>(XPlaneActuator<P>);

/// The state of the link to a board, readable from any thread.
#[derive(Debug)]
pub struct LinkStatus {
    /// Of its serial line, if it has one.
    pub line: Option<LineStatus>,
    /// Of its messages.
    pub messages: XPlaneStatus,
}

/// A board's sensor and actuator for a loop, and the state of the link.
pub type Devices = (
    Box<dyn Sensor<Measurements>>,
    Box<dyn Actuator<Surfaces>>,
    LinkStatus,
);

/// Opens the link. Nothing is sent before the first tick, and over UDP the board
/// need not be there yet.
///
/// # Errors
/// When the serial line or a socket cannot be opened, or the configuration is
/// refused.
pub fn open(config: &ServoBoardConfig) -> Result<Devices, OpenError> {
    match &config.link {
        Link::Udp(board) => {
            let (sensor, actuator) = open_udp(config, board)?;
            let status = sensor.status();
            Ok((Box::new(sensor), Box::new(actuator), status))
        }
        Link::Serial { path, baud } => {
            let (sensor, actuator, _) = open_serial(config, path, *baud)?;
            let status = sensor.status();
            Ok((Box::new(sensor), Box::new(actuator), status))
        }
    }
}

/// Opens the link over UDP.
///
/// # Errors
/// When a socket cannot be opened, or the configuration is refused.
pub fn open_udp(
    config: &ServoBoardConfig,
    board: &Simulator,
) -> Result<(ServoBoardSensor<UdpPort>, ServoBoardActuator<UdpPort>), OpenError> {
    let (messages, actuator) = XPlane::open(&config.x_plane(board.clone()))?;
    let sensor = ServoBoardSensor {
        messages,
        line: None,
        corrupt: 0,
    };
    Ok((sensor, ServoBoardActuator(actuator)))
}

/// The devices on a serial line, and the line's status.
pub type OnLine = (
    ServoBoardSensor<SerialPort>,
    ServoBoardActuator<SerialPort>,
    LineStatus,
);

/// Opens the link over a serial line.
///
/// # Errors
/// When the line cannot be opened, or the configuration is refused.
pub fn open_serial(
    config: &ServoBoardConfig,
    path: &Path,
    baud: Baud,
) -> Result<OnLine, OpenError> {
    let port = SerialPort::open(path, baud, config.priority).map_err(|source| OpenError::Line {
        path: path.to_owned(),
        source,
    })?;
    let status = port.status();
    let (messages, actuator) = XPlane::over(&config.x_plane(Simulator::At(BOARD)), port, None)?;
    let sensor = ServoBoardSensor {
        messages,
        line: Some(status.clone()),
        corrupt: 0,
    };
    Ok((sensor, ServoBoardActuator(actuator), status))
}

#[deny(
    clippy::missing_trait_methods,
    reason = "a method that is not passed on would have its default"
)]
impl<P: Port> Sensor<Measurements> for ServoBoardSensor<P> {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        self.messages.sample(tick, into)?;
        let line = self.line.as_ref();
        let corrupt = line.map_or(0, |line| line.corrupt() + line.floods());
        if corrupt == self.corrupt {
            return Ok(());
        }
        self.corrupt = corrupt;
        Err(SensorFault::Malformed)
    }

    fn fallback_after(&self) -> Duration {
        self.messages.fallback_after()
    }

    fn warm_up(&self, tick: &Tick) {
        self.messages.warm_up(tick);
    }

    fn name(&self) -> &'static str {
        NAME
    }
}

#[deny(
    clippy::missing_trait_methods,
    reason = "a method that is not passed on would have its default"
)]
impl<P: Port> Actuator<Surfaces> for ServoBoardActuator<P> {
    fn ready(&self) -> Result<(), ActuatorFault> {
        self.0.ready()
    }

    fn apply(&mut self, tick: &Tick, outputs: &Surfaces) -> Result<(), ActuatorFault> {
        self.0.apply(tick, outputs)
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.0.release()
    }

    fn warm_up(&self, tick: &Tick, outputs: &Surfaces) {
        self.0.warm_up(tick, outputs);
    }

    fn name(&self) -> &'static str {
        NAME
    }
}
