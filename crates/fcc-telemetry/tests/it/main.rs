//! Tests of fcc-telemetry: one program, so that what they share is linked once.
#![cfg(test)]

#[cfg(feature = "flight")]
mod prepared_commands;
#[cfg(feature = "flight")]
mod score_agrees_with_python;
