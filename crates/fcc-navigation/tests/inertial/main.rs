//! Navigation from raw sensors, on flights whose truth is known.

#![allow(
    clippy::indexing_slicing,
    reason = "axes of vectors of three, in what only tests use"
)]

mod chosen;
mod consistency;
mod drifts;
mod flight;
mod flights;
mod gaps;
mod gyroscope;
mod hand;
mod in_flight;
mod jumps;
mod matched;
mod noise;
mod sensors;
mod several;
mod units;
mod velocities;
