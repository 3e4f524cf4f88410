//! A phone's sensors as a sensor of a flight: accelerometer, gyroscope, magnetometer
//! and barometer by Android's native interface, positions by the app.
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
//!
//! Off Android `libandroid.so` is looked for when a sensor is opened: tests play one.

mod health;
mod kind;
mod library;
mod phone;
mod position;
mod source;
mod stamps;

pub use health::{Accuracy, SensorHealth};
pub use kind::Kind;
pub use phone::{Phone, PhoneHandle, PhoneSensor, PhoneSettings};
pub use position::{PositionReport, PositionSender};
pub use stamps::{Clocks, StampClock};
