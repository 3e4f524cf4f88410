//! The vehicle's side of MAVLink 2: frames in, frames out, no sockets.
//!
//! ```text
//! bytes ─► Links ─► Signing ─► Protocol ─┬─► Commands, by the table of commands ─► Request
//!                                        ├─► Missions: transactions of lists ────► Request
//!                                        ├─► Parameters, Control, Logs
//! VehicleState ─► messages ─► Streams ───┴─► Links, within their rate ─► bytes
//! ```
//!
//! [`Protocol`] has no clock, thread or socket: time is passed in, and what the vehicle is to
//! do comes out as a [`Request`], which is answered later. So a lossy link is a test that
//! takes no time.
//!
//! What arrives is read from its raw payload: a command or a frame of coordinates that is not
//! known gets its answer, and is not lost.
#![forbid(unsafe_code)]

mod command;
mod commands;
mod control;
mod effects;
mod frame;
mod item;
mod link;
mod log;
mod message;
mod mission;
mod mode;
mod parameter;
mod protocol;
mod signing;
mod streams;
mod vehicle;

pub use link::LinkOptions;
pub use log::{Log, LogWanted};
pub use parameter::Parameter;
pub use protocol::{Protocol, Settings, Severity};
pub use signing::{Key, read_key};
pub use vehicle::{
    Action, Attitude, Flight, Health, Identity, LinkId, Mode, Motion, Now, Outcome, Position,
    Request, Sensors, VehicleState,
};
