//! Devices on serial lines: satellite receivers and RC receivers.
//!
//! | module | contents |
//! |---|---|
//! | `line` | [`SerialLine`]: a line of the operating system, at any rate |
//! | `frames` | [`Frames`]: finds the frames of a [`Protocol`] in a stream of bytes |
//! | `ubx`, `nmea`, `epoch` | what satellite receivers say |
//! | `gnss` | [`GnssReceiver`]: such a receiver as a source of fixes |
//! | `sbus`, `crsf`, `channels` | what RC receivers say |
//! | `pilot` | [`Pilot`]: switch and sticks of channels |
//! | `rc` | [`RcReceiver`]: such a receiver as a source of both |

mod channels;
mod crsf;
mod epoch;
mod frames;
mod gnss;
mod line;
mod nmea;
mod pilot;
mod rc;
mod sbus;
mod ubx;

pub use channels::{CHANNELS, ReceiverFrame, position, pulse_us};
pub use crsf::Crsf;
pub use epoch::{Epoch, Epochs};
pub use frames::{Begin, Frames, Protocol};
pub use gnss::{GnssReceiver, GnssSettings};
pub use line::{LineSettings, SerialLine};
pub use nmea::{Nmea, Sentence};
pub use pilot::{Pilot, RcChannel, RcChannels, RcValues};
pub use rc::{RcProtocol, RcReceiver};
pub use sbus::Sbus;
pub use ubx::{NavPvt, Ubx, UbxMessage, configuration};
