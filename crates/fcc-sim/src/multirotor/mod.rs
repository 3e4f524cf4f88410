//! A built-in multicopter: rotors with drag, motors with lag, a battery that sags, feet on the
//! ground, the wind and the gusts of the built-in aircraft.
//!
//! It shares no code and no parameters with the autopilot that flies it.

mod body;
mod frame;
mod simulation;

pub use body::Multirotor;
pub use frame::{Frame, FrameRotor, LithiumBattery};
pub use simulation::{
    MultirotorActuator, MultirotorConfig, MultirotorSensor, MultirotorSimulation,
};
