//! Puts a flight together and flies it: what every program around a flight
//! has in common, be it a daemon, a Python module or an app.
//!
//! | module | what it does |
//! |---|---|
//! | [`config`] | reads and checks the configuration file |
//! | [`flight`] | makes a loop of a configuration, flies it and watches |
//! | [`replay`] | flies a recording again and compares |

pub mod config;
pub mod flight;
pub mod replay;
