//! The control framework: what every plant shares, an aircraft or a room.
//!
//! A loop wakes once a [`Tick`], lets each [`Sensor`] write its part of the
//! measurements, steps a [`Controller`] and hands the outputs to each
//! [`Actuator`]. Which [`State`] the loop is in, and why, follows one
//! transition table ([`State::after`]). The loop itself lives in
//! `fcc-runtime`; here are the parts it holds and the words they exchange.

mod actuator;
mod controller;
mod flags;
mod reading;
mod sensor;
mod state;
mod tick;
mod time;

pub use actuator::{Actuator, ActuatorFault};
pub use controller::{Controller, Switch};
pub use flags::Flags;
pub use reading::Reading;
pub use sensor::{Sensor, SensorFault};
pub use state::{Cause, Input, State, SwitchOff};
pub use tick::Tick;
pub use time::Time;
