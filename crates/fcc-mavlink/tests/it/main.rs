//! The vehicle's side of MAVLink against stations in lockstep: no sockets, no waiting.
//!
//! Stations are made of the crate `mavlink` alone, whose frames are not those of this crate.

#![cfg(test)]
#![expect(deprecated, reason = "stations still send what the dialect calls old")]
#![allow(clippy::indexing_slicing, reason = "helper functions of tests")]

mod commands;
mod hostile;
mod links;
mod logs;
mod lossy;
mod missions;
mod opening;
mod signing;
mod states;
mod stream;
mod world;

fn signing_key() -> fcc_mavlink::Key {
    fcc_mavlink::read_key(&"5a".repeat(32)).expect("a key")
}
