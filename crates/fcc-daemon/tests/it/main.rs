//! Tests of fcc-daemon: one program, so that what they share is linked once.
#![cfg(test)]

mod command_line;
mod replay;
mod report;
