//! What is measured and commanded in flight, the earth and the air: the types that
//! sensors, actuators and any vehicle's controller share.

mod altimeter;
pub mod atmosphere;
pub mod earth;
mod measurements;
mod motors;
pub mod orientation;
mod plant;
mod raw_readings;
mod surfaces;
pub mod terrain;

pub use altimeter::{ALTIMETER_SETTINGS_PA, Altimeter, AltitudeReference};
pub use measurements::{
    Attitude, BodyRates, Measurements, PilotControls, Position, SpecificForce, Velocity,
};
pub use motors::{MOST_ROTORS, Motors};
pub use plant::{OtherControl, Plant, PlantState};
pub use raw_readings::{Battery, GnssFix, MagneticField};
pub use surfaces::Surfaces;
