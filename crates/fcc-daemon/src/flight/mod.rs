//! Makes a loop of a configuration, flies it and watches.
//!
//! The loop runs in its own thread and knows nothing of what is here. This
//! side fetches what it tells, prints a status line each second, and gathers
//! the outcome.

mod assemble;
mod fly;
mod outcome;
mod status;
mod tap;
mod watch;

pub use assemble::{Assembly, AssemblyError, assemble};
pub use fly::{FlyError, Pace, Plan, fly};
pub use outcome::{EventEntry, Outcome};
