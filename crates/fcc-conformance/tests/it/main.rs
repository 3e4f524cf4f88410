//! Tests of fcc-conformance: one program, so that what they share is linked once.
#![cfg(test)]

mod broken;
mod guides;
