//! Devices on serial lines: satellite receivers and RC receivers.
//!
//! | module | contents |
//! |---|---|
//! | `frames` | [`Frames`]: finds the frames of a [`Protocol`] in a stream of bytes |
//! | `ubx`, `nmea`, `epoch` | what satellite receivers say |
//! | `sbus`, `crsf`, `channels` | what RC receivers say |

mod channels;
mod crsf;
mod epoch;
mod frames;
mod nmea;
mod sbus;
mod ubx;

pub use channels::{CHANNELS, ReceiverFrame, position, pulse_us};
pub use crsf::Crsf;
pub use epoch::Epochs;
pub use frames::{Begin, Frames, Protocol};
pub use nmea::{Nmea, Sentence};
pub use sbus::Sbus;
pub use ubx::{NavPvt, Ubx, UbxMessage, configuration};
