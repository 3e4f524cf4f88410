//! `fccd`, the flight control computer's daemon: its command line.
//!
//! | module | what it does |
//! |---|---|
//! | [`cli`], [`commands`], [`exit`] | what people type, what it does, how it ends |
//! | `process`, `observers` | what a flight needs of the process around it, and who observes it there |
//! | `output` | prints, and never panics where that fails |
//!
//! Assembling and running a flight is in [`fcc_flight`].

pub mod cli;
pub mod commands;
pub mod exit;
mod observers;
mod output;
mod process;

#[cfg(fuzzing)]
pub use process::use_plant_file;
