//! Tests of fcc-live: one program, so that what they share is linked once.
#![cfg(test)]

#[cfg(feature = "flight")]
mod commands;
mod layout_document;
