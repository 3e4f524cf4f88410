//! The aircraft: the values that travel, and the autopilot that turns
//! measurements into surfaces by navigation, guidance and control.

mod measurements;
mod setpoints;
mod surfaces;

pub use measurements::{
    Attitude, BodyRates, Measurements, Plant, PlantState, Position, SpecificForce, Velocity,
};
pub use setpoints::Setpoints;
pub use surfaces::Surfaces;
