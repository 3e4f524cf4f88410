//! Navigation from raw sensors, on flights whose truth is known.

#![allow(
    clippy::indexing_slicing,
    reason = "axes of vectors of three, in what only tests use"
)]

mod flight;
mod flights;
mod noise;
mod sensors;
mod thesis;
