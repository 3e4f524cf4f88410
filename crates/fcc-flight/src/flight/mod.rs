//! Makes a loop of a configuration, and flies it.
//!
//! The loop runs in its own thread and knows nothing of what is here. This
//! side fetches its messages, hands them to each [`Observer`], and gathers the
//! [`Outcome`]. What only the program around a flight can do is asked of its
//! [`Host`].

mod assemble;
#[cfg(feature = "live")]
mod commands;
mod event_log;
mod fly;
mod follow;
mod hang;
mod host;
#[cfg(feature = "fault-injection")]
mod injection;
#[cfg(feature = "live")]
mod live;
mod monitor;
mod observer;
mod observers;
mod outcome;
mod plan;
mod recording;
mod restart;
mod run_statistics;
mod scorer;
mod truth_recorder;

pub use assemble::{Assembly, AssemblyError, assemble, authority_without_connection};
pub use fly::{FlyError, fly};
pub use host::Host;
pub use observer::{Access, Facts, FlightTime, Observer, Report, Reports};
pub use outcome::{Conclusion, EventEntry, Outcome, RecordingOutcome};
pub use plan::{Length, Pace, Plan};
pub use recording::{RecordingRequest, about};
pub use scorer::true_sample;

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
