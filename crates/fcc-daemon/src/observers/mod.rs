//! Who observes a flight for the people and programs around the daemon.

mod announcer;
mod service;
mod status;

pub(crate) use announcer::Announcer;
pub(crate) use service::Service;
pub(crate) use status::StatusLine;
