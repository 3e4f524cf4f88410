//! Tests of fcc-record: one program, so that what they share is linked once.
#![cfg(test)]

#[cfg(feature = "flight")]
mod declared;
#[cfg(feature = "flight")]
mod recording;
