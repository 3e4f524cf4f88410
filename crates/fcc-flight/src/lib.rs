//! Assembles a flight and flies it: the part common to all host programs, such
//! as a daemon, a Python module or an app.
//!
//! | module | what it does |
//! |---|---|
//! | [`config`] | reads and checks the configuration file |
//! | [`flight`] | assembles a flight from a configuration, flies and observes it |
//! | [`probe`] | what is connected to the machine |
//! | [`replay`] | prepares the replay of a recorded flight |

pub mod config;
pub mod flight;
pub mod probe;
pub mod replay;
