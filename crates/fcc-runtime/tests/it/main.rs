//! Tests of fcc-runtime: one program, so that what they share is linked once.
#![cfg(test)]

mod bench;
mod exit_paths;
mod failsafe;
mod messages;
mod overload;
mod overruns;
mod prepared_release;
mod sources;
mod states;
mod switch;
mod thread;
mod warm_up;
mod watchdog;
