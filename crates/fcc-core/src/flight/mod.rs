//! The aircraft: its measurements, set points and outputs, and the autopilot
//! that computes surfaces from measurements by navigation, guidance and
//! control.
//!
//! | module | computes |
//! |---|---|
//! | [`navigation`] | position, attitude and motion |
//! | [`inertial`] | position, attitude and motion from raw sensors |
//! | [`guidance`] | set points |
//! | [`path`] | the bank that follows lines, arcs and circles over the ground |
//! | [`route`] | the order of legs, turns and circles of a flight plan |
//! | [`terrain`] | the height of the ground |
//! | [`control`] | surfaces and throttle |

mod altimeter;
pub mod atmosphere;
mod autopilot;
pub mod calibration;
pub mod control;
pub mod fence;
pub mod guidance;
pub mod inertial;
mod measurements;
pub mod navigation;
pub mod orientation;
pub mod path;
mod plant;
mod raw_readings;
pub mod route;
mod setpoints;
mod surfaces;
pub mod terrain;

pub use altimeter::{ALTIMETER_SETTINGS_PA, Altimeter, AltitudeReference};
pub use autopilot::{
    Autopilot, AutopilotCommand, AutopilotConfig, COMMAND_ANSWER, Contingency, ContingencyAction,
    ContingencyConfig, FailsafeConfig, FailsafeEnd, ITEM_REACHED, PlanReplacement, Resume, Scale,
    StickTakeover, flags, gives_up_runway, touches_ground, why_refused,
};
pub use measurements::{
    Attitude, BodyRates, Measurements, PilotControls, Position, SpecificForce, Suspect, Velocity,
};
pub use plant::{OtherControl, Plant, PlantState};
pub use raw_readings::{Battery, GnssFix, MagneticField};
pub use setpoints::Setpoints;
pub use surfaces::Surfaces;
