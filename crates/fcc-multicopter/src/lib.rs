//! The autopilot of multicopters: motor speeds from measurements.
//!
//! ```text
//! measurements ─► estimator ─► guidance ─► position ─► attitude ─► rate ─► allocation ─► motors
//!                    place,      modes,     thrust       turn      angular      which
//!                    motion      plan       vector       rates    acceleration  rotor
//! ```
//!
//! One table of rotors ([`Airframe`]) makes a quadrotor, a hexacopter or an octocopter. All
//! gains follow from one figure, the delay between a demand and its effect ([`Gains`]); a
//! configuration that cannot be flown is [refused](Refusal). Axes: body x forward, y right,
//! z down; earth north, east, down from the place where the first position was measured.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod airframe;
mod allocation;
mod attitude;
mod autopilot;
mod estimator;
mod gains;
mod guidance;
mod hover_thrust;
mod landing;
mod plan;
mod position;
mod rate;
mod rotor_watch;
mod trajectory;
mod values;

pub use airframe::{Airframe, Refusal, Rotor};
pub use allocation::{Allocated, Allocator, Demand};
pub use attitude::{attitude_of_thrust, rates_to};
pub use autopilot::{Multicopter, MulticopterConfig, flags};
pub use estimator::{Estimator, State};
pub use gains::Gains;
pub use guidance::{ITEM_REACHED, Limits};
pub use hover_thrust::HoverThrust;
pub use landing::LandingDetector;
pub use plan::{Item, Waypoint};
pub use position::{PositionLoop, Reference};
pub use trajectory::{Leg, Trajectory};
pub use values::{
    Command, Estimate, GoTo, GroundContact, Mode, Setpoints, Shortfall, Tilt, Velocity,
};
