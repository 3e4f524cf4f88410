//! The ground station: a page with map, flight plan, flight and recordings, beside the
//! daemon.
//!
//! ```text
//! shared memory ─► live ─┐
//! recordings ─► flights ─┼─► station ─► guard ─► server ─► browsers
//! drafts, plans, upload ─┘
//! ```
//!
//! It is a process of its own: it reads what a daemon publishes, and sends commands as
//! `fccd command` does. Whatever happens to it, the flight goes on.

mod calibration;
mod cli;
mod columns;
mod commands;
mod daemon_config;
mod doctor;
mod drafts;
mod exit;
mod failure;
mod files;
mod flights;
mod guard;
mod live;
mod map;
mod page;
mod plans;
mod server;
mod start;
mod station;
mod token;
mod upload;

pub use cli::Cli;
pub use exit::Exit;
pub use start::{Running, StartError, run, runtime, start};
