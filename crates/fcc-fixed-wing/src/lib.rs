//! The autopilot of aeroplanes: throttle, elevator, aileron and rudder from
//! measurements, by the estimate of [`fcc_navigation`], the targets of
//! [`fcc_guidance`] and the loops of [`control`].
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod autopilot;
pub mod control;
mod setpoints;

pub use autopilot::{
    Autopilot, AutopilotCommand, AutopilotConfig, COMMAND_ANSWER, Contingency, ContingencyAction,
    ContingencyConfig, FailsafeConfig, FailsafeEnd, ITEM_REACHED, PlanReplacement, Resume, Scale,
    StickTakeover, flags, gives_up_runway, touches_ground, why_refused,
};
pub use setpoints::Setpoints;
