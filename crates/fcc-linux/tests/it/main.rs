//! Tests of fcc-linux: one program, so that what they share is linked once.
#![cfg(test)]

mod chips;
mod conformance;
mod iio;
mod lines;
mod receivers;
mod satellites;
mod servos;
mod streams;
mod switches;
