//! A phone's sensors as a sensor of a flight: accelerometer, gyroscope, magnetometer
//! and barometer by Android's native interface, positions by the app. And performance
//! hints, by which a phone learns how fast the loop has to be.
//!
//! ```text
//! accelerometer's thread ─┐
//! gyroscope's thread ─────┤  rings
//! magnetometer's thread ──┼────────► PhoneSensor, in the loop
//! barometer's thread ─────┤
//! position's thread ──────┘
//!        ▲ the app's location service
//! ```
//!
//! Each sensor has a looper and an event queue in a thread of its own, the
//! [`DeviceThread`](fcc_device::DeviceThread) that a board's devices have. What the
//! sensors give is in Android's axes: x to the right of the screen, y to its top, z out
//! of it.
//!
//! | module | contents |
//! |---|---|
//! | `library` | the functions of `libandroid.so`, and an event queue of them; all that is `unsafe` |
//! | `kind` | the kinds of sensors, and their events as values |
//! | `stamps` | which clock has stamped an event, and when that was on the loop's |
//! | `source` | a sensor as a [`Source`](fcc_device::Source) |
//! | `position` | positions that the app hands in, as a source |
//! | `health` | what the screens show of a sensor |
//! | `phone` | all of them as one sensor |
//! | `performance_hints` | a session of performance hints for a thread; `unsafe`, too |
//!
//! Off Android `libandroid.so` is looked for when a sensor is opened: tests play one.

mod health;
mod kind;
mod library;
mod performance_hints;
mod phone;
mod position;
mod source;
mod stamps;

pub use health::{Accuracy, SensorHealth};
pub use kind::Kind;
pub use performance_hints::{HintSession, NoHintSession};
pub use phone::{Phone, PhoneHandle, PhoneSensor, PhoneSettings};
pub use position::{PositionReport, PositionSender};
pub use stamps::{Clocks, StampClock};
