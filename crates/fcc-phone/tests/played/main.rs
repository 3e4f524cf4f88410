//! The phone's sensors and performance hints, with a `libandroid.so` that plays what
//! phones do.
#![cfg(test)]
#![allow(clippy::indexing_slicing, reason = "helper functions of tests")]

mod conformance;
mod fake;
mod performance_hints;
mod phones;
