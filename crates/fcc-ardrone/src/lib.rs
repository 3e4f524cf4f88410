//! The drone's side of the AR.Drone 2.0's protocol: datagrams in, datagrams out. It has no
//! sockets, clock or threads: the caller receives at [`COMMANDS_PORT`] and [`NAVDATA_PORT`] and
//! gives the time.
//!
//! A [`Session`] reads AT commands and says what is [wanted](Wanted) of the vehicle; it writes
//! what the client shows of it. Source: Parrot, AR.Drone Developer Guide SDK 2.0 (2012), chapters
//! 6 to 8.
#![forbid(unsafe_code)]

mod at;
mod limits;
mod navdata;
mod session;

pub use at::{Command, Malformed, Stick, commands};
pub use limits::Limits;
pub use navdata::{Flight, NAVDATA_BYTES, Seen};
pub use session::{Session, Wanted};

/// UDP port of the AT commands.
pub const COMMANDS_PORT: u16 = 5556;
/// UDP port of the state that the drone sends.
pub const NAVDATA_PORT: u16 = 5554;
