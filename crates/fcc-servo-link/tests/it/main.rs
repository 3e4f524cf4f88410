//! Tests of fcc-servo-link: one program, so that what they share is linked once.
#![cfg(test)]

mod conformance;
mod line;
mod support;
