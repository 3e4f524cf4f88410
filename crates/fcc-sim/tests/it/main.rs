//! Tests of fcc-sim: one program, so that what they share is linked once.
#![cfg(test)]

mod atmosphere;
mod conformance;
mod engine_and_battery;
mod flight;
mod handling;
mod modes;
mod performance;
mod pilot;
mod raw_sensors;
mod reproducible;
mod simulation;
mod spin;
mod standing;
mod turbulence;
