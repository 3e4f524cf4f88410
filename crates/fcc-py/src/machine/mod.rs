//! The daemon's loop with states, failsafe and recording, one call per tick,
//! for a plant in Python.

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
