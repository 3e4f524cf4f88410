//! The aircraft: the values that travel, and the autopilot that turns
//! measurements into surfaces by navigation, guidance and control.
//!
//! | module | answers |
//! |---|---|
//! | [`navigation`] | where are we, how do we move? |
//! | [`guidance`] | where to go next? (set points) |
//! | [`control`] | which surfaces, what throttle? |

pub mod atmosphere;
mod autopilot;
pub mod control;
pub mod guidance;
mod measurements;
pub mod navigation;
pub mod orientation;
mod setpoints;
mod surfaces;

pub use autopilot::{Autopilot, AutopilotCommand, AutopilotConfig, Resume, Scale, flags};
pub use measurements::{
    Attitude, BodyRates, Measurements, Plant, PlantState, Position, SpecificForce, Velocity,
};
pub use setpoints::Setpoints;
pub use surfaces::Surfaces;
