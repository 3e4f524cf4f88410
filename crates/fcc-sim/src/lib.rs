//! The built-in aircraft, for use without a simulator.
//!
//! A rigid body with six degrees of freedom, the published derivatives of a
//! light single-engined aircraft, a stall and a spin, an engine with a
//! fixed-pitch propeller, a battery, actuators, the standard atmosphere, wind, gusts,
//! sensor errors, and a ground that ends the flight. It advances by the time of the ticks with which it is sampled: in
//! real time in a loop, or in lockstep some thousand times faster. The same
//! seed gives the same flight to the last bit on every machine, because
//! transcendental functions are those of `libm` and random numbers those of
//! this crate.
//!
//! ```
//! use fcc_core::flight::{Measurements, Surfaces};
//! use fcc_core::framework::{Actuator, Sensor, Tick};
//! use fcc_sim::{SimConfig, Simulation};
//!
//! let mut sim = Simulation::new(&SimConfig::default())?;
//! let tick = Tick { dt_s: 0.025, ..Tick::default() };
//! let mut measured = Measurements::default();
//! for _ in 0..40 {
//!     sim.sensor.sample(&tick, &mut measured)?;
//!     sim.actuator.apply(&tick, &Surfaces {
//!         throttle: sim.trim.throttle,
//!         aileron: 0.2,
//!         ..Surfaces::default()
//!     })?;
//! }
//! assert!(measured.attitude.value.roll_rad > 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | contents |
//! |---|---|
//! | [`airframe`] | mass, size, derivatives: data, with sources |
//! | [`atmosphere`] | standard air, airspeeds |
//! | [`aerodynamics`] | forces and moments of air and propeller |
//! | [`propeller`] | the engine's speed |
//! | [`electrical`] | battery and alternator |
//! | [`motion`] | the equations of motion and their integration |
//! | [`multirotor`] | a multicopter |
//! | [`turbulence`] | Dryden gusts |
//!
//! Not modelled: flaps, a retractable gear, the propeller's torque on the airframe,
//! gyroscopic effect, inertia and slipstream, ice, fuel burn (mass is constant) and Mach
//! number.
#![forbid(unsafe_code)]

pub mod aerodynamics;
mod aircraft;
pub mod airframe;
pub mod atmosphere;
mod config;
pub mod electrical;
mod flow;
pub mod gauss;
pub mod gear;
mod ground;
mod handling;
mod link;
mod local_earth;
pub mod motion;
pub mod multirotor;
pub mod propeller;
mod raw;
mod sensing;
pub mod servos;
mod simulation;
mod stall;
mod state;
mod trim;
mod truth;
pub mod turbulence;
pub mod units;

pub use aircraft::{Aircraft, LONGEST_STEP_S};
pub use airframe::Airframe;
pub use config::{
    Channels, LONGEST_DELAY_MS, SensorConfig, SimConfig, SimError, SwitchScript, Wind,
};
pub use electrical::Electrical;
pub use handling::{HandledSensors, HandlingFault, HandlingTask};
pub use link::{SwitchHandle, TruthHandle};
pub use multirotor::{MultirotorConfig, MultirotorSimulation};
pub use raw::{AxisErrors, RawSensor, RawSensorSet, RawSensors, RawTruth, TrueErrors};
pub use simulation::{SimActuator, SimSensor, Simulation};
pub use trim::{Trim, TrimError, trim};
pub use truth::{HasTruth, Truth};
pub use turbulence::Severity;
