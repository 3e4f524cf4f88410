//! Fixes of satellite navigation from gpsd, the usual service for receivers on
//! Linux, by its JSON over TCP.
//!
//! The protocol is that of `gpsd_json(5)`, protocol 3: objects in lines, each
//! with its `class`.
//!
//! | module | contents |
//! |---|---|
//! | `report` | [`Report`]: what a line says |
//! | `lines` | [`Lines`]: lines in a stream of bytes, of at most [`Lines::LONGEST`] |
//! | `client` | [`Gpsd`]: the service as a source of fixes |

mod client;
mod lines;
mod report;

pub use client::{Gpsd, GpsdSettings};
pub use lines::{LineTooLong, Lines};
pub use report::{NotGpsd, Report};
