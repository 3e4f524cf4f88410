//! The Python module `fcc`: what the flight control computer computes and
//! records, for tests and experiments.
//!
//! | module | content |
//! |---|---|
//! | `autopilot`, `fleet` | the autopilot, one call per tick; many of them in one call |
//! | `machine` | the daemon's loop, one call per tick, for a plant in Python: for the autopilot, and for any controller whose types have a schema |
//! | `flight`, `callbacks` | a whole flight of the built-in aircraft in one call, with sensors or a controller in Python |
//! | `aircraft` | the built-in aircraft alone |
//! | `config`, `plan` | configurations, by key; flight plans |
//! | `blocks`, `formulas` | the core's blocks and formulas |
//! | `calibrate` | the calibration of a sensor of three axes |
//! | `navigate` | navigation from arrays of raw samples |
//! | `timers` | the kernel's timers |
//! | `recordings` | recordings of any plant as numpy arrays; list, recover, report, replay |
//! | `live` | a running loop of any plant, watched and given commands |
//! | `values`, `structured` | structs with a schema as classes and as structured arrays |
//! | `events`, `errors`, `arguments`, `json` | events, exceptions, checks, dicts |
//!
//! Nothing is computed here: each call is passed on to the crate that the daemon
//! uses.
//! Without the feature `flight` only what the loop of any controller needs is
//! compiled: `examples/pendulum` is a module of its own on it, with the same
//! `Recording` and `Watcher`.

#![allow(
    clippy::doc_link_with_quotes,
    reason = "documents have examples of Python"
)]
#![cfg_attr(
    not(feature = "flight"),
    allow(dead_code, reason = "the aircraft uses more of it than other plants")
)]

#[cfg(feature = "flight")]
mod aircraft;
mod arguments;
#[cfg(feature = "flight")]
mod autopilot;
#[cfg(feature = "flight")]
mod blocks;
#[cfg(feature = "flight")]
mod callbacks;
#[cfg(feature = "flight")]
mod commanded;
#[cfg(feature = "flight")]
mod config;
#[cfg(feature = "conformance")]
mod conformance;
pub mod errors;
pub mod events;
#[cfg(feature = "flight")]
mod fleet;
#[cfg(feature = "flight")]
mod flight;
#[cfg(feature = "flight")]
mod formulas;
mod json;
#[cfg(feature = "live")]
pub mod live;
#[macro_use]
pub mod machine;
#[cfg(feature = "flight")]
mod calibrate;
#[cfg(feature = "flight")]
mod navigate;
#[cfg(feature = "flight")]
mod plan;
#[cfg(feature = "flight")]
mod raw_sensors;
pub mod recordings;
#[cfg(feature = "flight")]
mod stepped;
pub mod structured;
#[cfg(feature = "flight")]
mod timers;
#[macro_use]
pub mod values;

#[cfg(feature = "flight")]
mod module;
