//! The computations of the flight control computer: everything that is computed
//! inside a tick, and nothing else.
//!
//! No I/O, no clock, no heap: a tick is a pure function of the loop's state,
//! the measurements, the commands and the tick's time, so a recording of them
//! can be replayed to the last bit on any machine. Transcendental functions
//! come from `libm` for the same reason: those of platforms differ in the last
//! digit.
//!
//! | module | contents |
//! |---|---|
//! | [`framework`] | ticks, readings, sensors, actuators, controllers, the loop's states: any plant |
//! | [`blocks`] | PID, filters, limiters: any plant |
//! | [`units`] | feet, knots and gravity in SI |
//! | [`flight`] | measurements, surfaces, the earth and the air |
//!
//! Internally everything is in SI units and radians; feet, knots and degrees
//! are used only at the interfaces to users and simulators. Body axes are x
//! forward, y right, z down; heading is clockwise from north.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod blocks;
pub mod flight;
pub mod framework;
pub mod units;
