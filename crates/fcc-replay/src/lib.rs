//! Replays a recording with the code that ran it.
//!
//! A tick of the loop is a pure function of the loop's state, the tick's times,
//! the measurements and the inputs from outside (commands, the stop flag); a
//! recording holds all of these. The same [`Machine`](fcc_runtime::Machine)
//! with the same controller and the recorded inputs must therefore produce the
//! recorded outputs, to the last bit. This holds for every controller.
//!
//! ```text
//! messages ─► Sequence ─► Machine (recorded times, a sensor that returns the
//!             commands,            recorded measurements, no plant)
//!             gaps                    │
//!                 └── recorded ───► Identity, or Deviation of another configuration
//! ```
//!
//! The state of the loop is not in a recording. A replay therefore starts with
//! the loop's first tick, and ends where records are missing: later ticks
//! depend on them.

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
pub use run::{NotReplayed, Replay, Run, run};
pub use sequence::Cut;
