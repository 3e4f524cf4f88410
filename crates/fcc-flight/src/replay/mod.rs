//! Flies a recording again, through the very code that flew it.
//!
//! A tick of the loop is a pure function of the loop's state, the tick's
//! times, the measurements and what came from outside (commands, the stop flag);
//! a recording holds all of these. So the same [`Machine`](fcc_runtime::Machine)
//! with the same autopilot, handed what was recorded, must give what was
//! recorded, to the last bit.
//!
//! ```text
//! messages ─► Sequence ─► Machine (recorded times, a sensor that hands out the
//!             what came            recorded measurements, no aircraft)
//!             in, gaps                │
//!                 └── recorded ───► Identity, or Deviation from another configuration
//! ```
//!
//! State that is not in a recording is what the loop had gathered before its
//! first record. Hence a replay begins where the loop began, and ends where
//! records are missing: what comes after depends on what is lost.

mod chain;
mod csv;
mod deviation;
mod fields;
mod identity;
mod parts;
mod profile;
mod run;
mod sequence;

pub use chain::{Chain, ChainError, ChainMessages};
pub use csv::Csv;
pub use deviation::{Deviation, Quantity, QuantityDeviation};
pub use identity::{Difference, FieldDifference, Identity};
pub use run::{Replay, Run, Unflown, run};
pub use sequence::Cut;
