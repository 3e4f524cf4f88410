//! Checks `fccd` against a running X-Plane in twenty steps, and writes a report
//! that can be sent to others.
//!
//! The check is a second client of X-Plane beside the daemon: it starts the
//! daemon as a process of its own with the user's configuration, and reads from
//! X-Plane, over its own socket, what the daemon does there. So what is checked
//! is the program that flies, and the judgement does not depend on it.
//!
//! | module | contents |
//! |---|---|
//! | `step`, `steps` | the twenty steps: what happens, what is watched, which limits |
//! | `bench` | what a step works with: waits, figures, the person or the cues |
//! | `link`, `watched` | the connection to X-Plane and the datarefs read over it |
//! | `daemon`, `configuration` | the daemon's process and its configuration |
//! | `disturbance` | what makes a measured response wrong |
//! | `identify` | how an aircraft responds to its controls |
//! | `waits` | how long each part takes, in full and shortened |
//! | `screen` | what a program that runs the check has to provide |
//! | `report` | the results as text and JSON |
//!
//! A step is done by a person, who is told what to do, or unattended. Where
//! X-Plane has a command or a dataref for it, the check uses that in both
//! cases. For the rest, unattended, it sends commands under `fccd/check/step/`:
//! X-Plane does not know them, and a stand-in for X-Plane takes them as cues to
//! do what a person would.
#![forbid(unsafe_code)]

mod bench;
mod check;
mod configuration;
mod daemon;
mod disturbance;
mod envelope;
mod figure;
mod identify;
mod link;
mod report;
mod result;
mod screen;
mod step;
mod steps;
mod waits;
mod watched;

pub use check::{CheckError, Request, check};
pub use configuration::ConfigurationError;
pub use figure::Figure;
pub use identify::{FlownBy, Identified, IdentifyError, Response, identify};
pub use report::{Report, Simulator};
pub use result::{Outcome, StepResult};
pub use screen::{Answer, Screen};
pub use step::Step;
pub use steps::STEPS;
