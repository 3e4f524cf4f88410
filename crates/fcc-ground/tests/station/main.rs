//! The station as a browser, and an attacker, meets it: a real server on a port.
#![cfg(test)]

mod attacks;
mod common;
mod drafts;
mod flights;
mod foxglove;
mod hostile_files;
mod live;
mod load;
mod protocol;
