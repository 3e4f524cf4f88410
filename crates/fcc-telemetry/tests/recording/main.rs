//! Recordings from outside: what goes in comes back, whatever the disk does.
#![cfg(test)]

mod cut;
mod disk;
mod flight;
mod folder;
mod round_trip;
