//! The link to a servo board, as a sensor and an actuator: the board gives
//! airspeed and the engage switch, and takes the surfaces.
//!
//! The board speaks X-Plane's messages (`fcc-servo-board` is its side), so this
//! is the adapter for X-Plane, asking for less: over UDP as it is, and over a
//! serial line by another [`Port`](fcc_xplane::Port). So writing is confirmed by
//! reading back and a release is repeated until the board confirms it, as in a
//! simulator. What a board does not measure is no fault: other sensors give it.
//!
//! ```no_run
//! use fcc_servo_link::{Baud, Link, ServoBoardConfig, open};
//!
//! let config = ServoBoardConfig {
//!     link: Link::Serial {
//!         path: "/dev/ttyUSB0".into(),
//!         baud: Baud::B115200,
//!     },
//!     ..ServoBoardConfig::default()
//! };
//! let (sensor, actuator, line) = open(&config)?;
//! # drop((sensor, actuator, line));
//! # Ok::<(), fcc_servo_link::OpenError>(())
//! ```
//!
//! # The serial line
//!
//! A tick never touches the line: opening, writing and closing a terminal may
//! wait in its driver. A thread, `relay`, carries messages between the line and
//! a pair of sockets, and the loop sends and receives on its end without
//! waiting. If the line is lost, that thread opens it again as soon as it is
//! back; until then sensor and actuator report the operating system's error. The
//! queue towards the line is short, and what does not fit it is a fault, too. The
//! thread needs a real-time priority on a busy machine: the board gives up after
//! 200 ms.
//!
//! The board has its own failsafe, so nothing has to release it on behalf of a
//! program that was killed: there is no control authority.
#![forbid(unsafe_code)]

mod config;
mod device;
mod line;
mod relay;
mod serial_port;
mod tty;

pub use config::{Link, ServoBoardConfig};
pub use device::{
    Devices, LinkStatus, OnLine, OpenError, ServoBoardActuator, ServoBoardSensor, open,
    open_serial, open_udp,
};
pub use line::LineStatus;
pub use serial_port::SerialPort;
pub use tty::{Baud, NoSuchBaud};
