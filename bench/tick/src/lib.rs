//! The cost of a tick. This library assembles what is measured: a whole loop
//! that flies a simulated X-Plane over loopback ([`Flight`]), and its single
//! stages ([`Stages`]). The benches measure time and count instructions; the
//! programs count system calls and bytes of memory, and measure the latency.
//! `make bench` runs them all; `docs/results/timing.md` has the results.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a benchmark that cannot be set up ends"
)]

mod flight;
pub mod marks;
mod stages;
#[allow(
    missing_docs,
    clippy::missing_panics_doc,
    clippy::new_without_default,
    reason = "it is a test's own"
)]
#[path = "../../../crates/fcc-xplane/tests/it/support/mod.rs"]
mod support;

pub use flight::Flight;
pub use stages::Stages;
pub use support::FakeXPlane;

/// The period of the loop that is measured.
pub const PERIOD: std::time::Duration = std::time::Duration::from_millis(25);
