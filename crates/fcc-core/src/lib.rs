//! The flight control computer's computing part: everything that is worked out
//! inside a tick, and nothing else.
//!
//! No I/O, no clock, no heap: a tick is a pure function of the loop's state,
//! the measurements, the commands and the tick's time, so a recording of those
//! replays to the last bit on any machine. Transcendental functions come from
//! `libm` for the same reason: the platform's own differ in the last digit.
//!
//! | module | what it knows |
//! |---|---|
//! | [`framework`] | ticks, readings, sensors, actuators, controllers, the loop's states: any plant |
//! | [`blocks`] | PID, filters, limiters: any plant |
//! | [`flight`] | measurements, navigation, guidance, control of an aircraft (feature `flight`) |
//!
//! Inside, everything is SI units and radians; feet, knots and degrees exist
//! at the edges only. Body axes are x forward, y right, z down; heading is
//! clockwise from north.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod blocks;
#[cfg(feature = "flight")]
pub mod flight;
pub mod framework;
