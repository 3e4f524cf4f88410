//! `fccd`, the flight control computer's daemon: configuration, putting the
//! parts together, commands for people.
//!
//! | module | what it does |
//! |---|---|
//! | [`config`] | reads and checks the configuration file |
//! | [`cli`], [`commands`], [`exit`] | what people type, what it does, how it ends |
//! | [`doctor`] | says what the machine offers a real-time loop, and what it lacks |
//! | [`flight`] | makes a loop of a configuration, flies it and watches |
//! | `output` | prints, and never panics where that fails |
//! | [`replay`] | flies a recording again and compares |
//!
//! The library is for the Python module, which reads the same configuration.

pub mod cli;
pub mod commands;
pub mod config;
pub mod doctor;
pub mod exit;
pub mod flight;
mod output;
pub mod replay;
