//! The ground station: a page with map, flight plan, flight and recordings, beside the
//! daemon.
//!
//! ```text
//! shared memory ─► live ─┐            ┌─► guard ─► server ─► browsers
//! recordings ─► flights ─┼─► station ─┤
//! drafts, plans, upload ─┘            └─► mavlink ─► other ground stations
//! ```
//!
//! It is a process of its own: it reads what a daemon publishes, and sends commands as
//! `fccd command` does. Whatever happens to it, the flight goes on.

mod calibration;
mod cli;
mod columns;
mod daemon_config;
mod doctor;
mod drafts;
mod exit;
mod failure;
mod files;
mod flights;
mod guard;
mod hosts;
mod live;
mod map_file;
mod mavlink;
mod orders;
mod page;
mod plans;
mod requests;
mod server;
mod start;
mod station;
mod token;
mod upload;

pub use cli::{Cli, MavlinkArgs, MavlinkIdentity, MavlinkLinks};
pub use exit::Exit;
pub use mavlink::MavlinkLink;
pub use start::{Running, StartError, run, runtime, start};
