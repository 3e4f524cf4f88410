//! The autopilot seen from outside: scripted measurements in, surfaces out.
#![cfg(test)]

mod altimeter;
mod clocks;
mod cockpit;
mod event_texts;
mod faults;
mod flying;
mod future;
mod gate;
mod link_loss;
mod lost_altitude;
mod resuming;
mod silence;
