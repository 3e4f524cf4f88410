//! The daemon's loop with states, failsafe and recording, one call per tick,
//! for a plant in Python.

#[macro_use]
mod class;
#[cfg(feature = "flight")]
mod flight;
mod lockstep;
mod python_io;

#[cfg(feature = "flight")]
pub(crate) use flight::PyMachine;
pub use lockstep::{Lockstep, conditions};
#[cfg(feature = "conformance")]
pub(crate) use python_io::{HeldFlag, QueuedSensor};
