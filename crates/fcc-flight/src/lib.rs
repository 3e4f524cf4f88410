//! Assembles a flight and flies it: the part common to all host programs, such
//! as a daemon, a Python module or an app.
//!
//! | module | what it does |
//! |---|---|
//! | [`calibrate`] | guided calibration of a configuration's raw sensors, and the file of what was found |
//! | [`config`] | reads and checks the configuration file |
//! | [`flight`] | assembles a flight from a configuration, flies and observes it |
//! | [`probe`] | what is connected to the machine |
//! | [`release`] | releases the controls on behalf of a process that was killed |
//! | [`replay`] | prepares the replay of a recorded flight |
//! | [`vehicle`] | vehicles beside the aeroplane |

pub mod calibrate;
pub mod config;
pub mod flight;
pub mod probe;
pub mod release;
pub mod replay;
mod sealed;
pub mod vehicle;
