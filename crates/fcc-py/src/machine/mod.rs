//! The daemon's loop, one call a tick: its states, its failsafe and its
//! recording, around a plant in Python.

#[macro_use]
mod class;
#[cfg(feature = "flight")]
mod flight;
mod lockstep;
mod python_io;
mod replay;

#[cfg(feature = "flight")]
pub(crate) use flight::PyMachine;
pub use lockstep::{Lockstep, conditions};
pub use replay::replay;
