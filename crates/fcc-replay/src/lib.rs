//! Runs a recording again, through the very code that ran it.
//!
//! A tick of the loop is a pure function of the loop's state, the tick's
//! times, the measurements and what came from outside (commands, the stop flag);
//! a recording holds all of these. So the same [`Machine`](fcc_runtime::Machine)
//! with the same controller, given what was recorded, must produce what was
//! recorded, to the last bit. This holds for every controller: nothing here
//! knows what it controls.
//!
//! ```text
//! messages ─► Sequence ─► Machine (recorded times, a sensor that returns the
//!             commands,            recorded measurements, no plant)
//!             gaps                    │
//!                 └── recorded ───► Identity, or Deviation of another configuration
//! ```
//!
//! State that is not in a recording is what the loop had gathered before its
//! first record. Hence a replay begins where the loop began, and ends where
//! records are missing: what comes after depends on what is lost.

mod chain;
mod comparison;
mod csv;
mod deviation;
mod identity;
mod outputs;
mod parts;
mod profile;
mod quantity;
mod run;
mod sequence;

pub use chain::{Chain, ChainError, Replayed};
pub use comparison::Comparison;
pub use csv::Csv;
pub use deviation::{Deviation, QuantityDeviation};
pub use identity::{Difference, FieldDifference, Identity};
pub use quantity::Quantity;
pub use run::{Replay, Run, Unflown, run};
pub use sequence::Cut;
