//! Tests of fcc-xplane: one program, so that what they share is linked once.
#![cfg(test)]

mod conformance;
mod finding;
mod following;
mod golden;
mod observing;
mod ports;
mod properties;
mod reading;
mod support;
mod traffic;
mod warm_up;
mod writing;
