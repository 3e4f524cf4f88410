//! Tests of fcc-flight: one program, so that what they share is linked once.
#![cfg(test)]

mod board_lines;
mod board_sensors;
mod check_controls;
mod examples;
mod order;
mod plan;
mod simulator_silence;
mod vehicle;
mod warm_up;
