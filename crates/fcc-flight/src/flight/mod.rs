//! Makes a loop of a configuration, flies it and watches.
//!
//! The loop runs in its own thread and knows nothing of what is here. This
//! side fetches what it tells, prints a status line each second, and gathers
//! the outcome.

mod assemble;
mod connection;
mod fly;
mod follow;
mod guard;
mod hang;
#[cfg(feature = "fault-injection")]
mod injection;
#[cfg_attr(not(feature = "live"), path = "not_live.rs")]
mod live;
#[cfg(feature = "live")]
mod commands;
mod outcome;
mod plan;
mod recording;
mod relief;
mod restart;
mod service;
mod signals;
mod instance_lock;
mod status;
mod run_statistics;
mod truth_recorder;
mod watch;

pub use assemble::{Assembly, AssemblyError, assemble};
pub use fly::{FlyError, fly};
pub use guard::{ReleaseHelperError, run_release_helper};
pub use outcome::{EventEntry, Outcome, RecordingOutcome};
pub use plan::{Length, Pace, Plan};
pub use recording::{RecordingRequest, about};
pub use watch::true_sample;

type Sensors = Vec<Box<dyn fcc_core::framework::Sensor<fcc_core::flight::Measurements>>>;

/// What the loop runs.
#[cfg(not(feature = "fault-injection"))]
pub type Pilot = fcc_core::flight::Autopilot;
/// What the loop runs: an autopilot that goes wrong when it is told to.
#[cfg(feature = "fault-injection")]
pub type Pilot = injection::Faulty;

#[cfg(not(feature = "fault-injection"))]
fn sensors(sensors: Sensors) -> Sensors {
    sensors
}

#[cfg(feature = "fault-injection")]
fn sensors(mut sensors: Sensors) -> Sensors {
    sensors.push(Box::new(injection::Blocking::default()));
    sensors
}

#[cfg(not(feature = "fault-injection"))]
fn pilot(autopilot: fcc_core::flight::Autopilot) -> Pilot {
    autopilot
}

#[cfg(feature = "fault-injection")]
fn pilot(autopilot: fcc_core::flight::Autopilot) -> Pilot {
    injection::Faulty::new(autopilot)
}
