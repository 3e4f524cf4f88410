//! A control loop on this machine, live in a terminal: its state and timing, the
//! recorder, what happened, and its values, for every controller whose values
//! are declared. What only an aircraft has, as a horizon, is the feature
//! `flight`.
//!
//! | module | what it does |
//! |---|---|
//! | `picture` | what is known of the loop, from its live telemetry |
//! | `terminal` | the terminal: keys, redrawing, leaving it as it was |
//! | `screen`, `values`, `timing`, `health` | the screen and its parts |
//! | `snapshot` | the same as JSON |

#[cfg(feature = "flight")]
mod flight;
mod health;
mod picture;
mod screen;
mod snapshot;
mod terminal;
mod timing;
mod values;
mod watched;

#[cfg(all(test, feature = "flight"))]
mod tests;

pub use picture::Picture;
pub use screen::draw;
pub use snapshot::{json_of, snapshot};
pub use terminal::{TopError, top};
pub use watched::{Part, Watched};
