//! Tests of fcc-servo-board: one program, so that what they share is linked once.
#![cfg(test)]

mod board;
mod frames;
