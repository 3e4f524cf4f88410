//! The daemon's loop, one call a tick: its states, its failsafe and its
//! recording, around a plant in Python.

#[macro_use]
mod class;
mod flight;
mod lockstep;
mod python_io;

pub(crate) use flight::PyMachine;
pub(crate) use lockstep::{Lockstep, conditions};
