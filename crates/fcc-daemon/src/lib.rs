//! `fccd`, the flight control computer's daemon: configuration, putting the
//! parts together, commands for people.
//!
//! The library is for the Python module, which reads the same configuration.

pub mod config;
