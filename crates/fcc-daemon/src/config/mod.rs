//! The configuration file.
//!
//! TOML with units in the key names; unknown keys are refused. Inside is SI:
//! each section has one struct in the file's units and one way into the
//! core's.

mod autopilot;
mod units;

pub use autopilot::{AutopilotSection, CourseSection};
