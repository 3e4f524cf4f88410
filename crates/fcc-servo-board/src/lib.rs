//! The servo board's side of the link to the flight control computer, for the
//! maker of a board's firmware.
//!
//! The board measures airspeed, has the engage switch and drives the servos.
//! It speaks X-Plane's messages, so the computer that flies the simulator flies
//! the aircraft: values are requested by RREF, surfaces are written by rows of
//! DATA or by DREF, and control is taken and released by X-Plane's two
//! overrides. Over Wi-Fi each message is a UDP datagram; over a serial line
//! each is in a [frame](Encoder) with a sequence number and a checksum.
//!
//! Nothing here does I/O or reads a clock: bytes and the time are arguments.
//!
//! ```
//! use fcc_servo_board::{Board, BoardConfig, Decoder, Encoder, MAX_FRAME, Readings};
//!
//! let mut board = Board::new(BoardConfig::default());
//! let (mut decoder, mut encoder) = (Decoder::new(), Encoder::new());
//!
//! // In the firmware's loop, every few milliseconds:
//! # let (received, now_ms) = ([0_u8; 4], 20);
//! for byte in received {
//!     if let Some(message) = decoder.push(byte) {
//!         // One that the board does not know is left out.
//!         let _ = board.receive(now_ms, (), message);
//!     }
//! }
//! let readings = Readings {
//!     airspeed_mps: Some(18.0),
//!     engage_switch: Some(false),
//!     ..Readings::default()
//! };
//! let mut message = [0; fcc_servo_board::MAX_MESSAGE];
//! if let Some(reply) = board.poll(now_ms, &readings, &mut message) {
//!     let mut frame = [0; MAX_FRAME];
//!     if let Some(bytes) = encoder.frame(reply, &mut frame) {
//!         // Send `bytes` over the serial line.
//!         # let _ = bytes;
//!     }
//! }
//! // Nobody has taken the servos yet: the pilot's receiver drives them.
//! assert_eq!(board.drive().surfaces, None);
//! ```
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod board;
mod config;
mod frame;
mod message;
mod subscriptions;
mod surfaces;
mod value;

pub use board::{Board, Control, Drive};
pub use config::BoardConfig;
pub use frame::{Decoder, Encoder, LineCounts, MAX_FRAME, MAX_MESSAGE};
pub use message::{NotForBoard, shortened};
pub use surfaces::Surfaces;
pub use value::{DIFFERENTIAL_PRESSURE, ENGAGE_SWITCH, Readings};
