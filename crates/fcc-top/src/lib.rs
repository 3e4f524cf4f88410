//! Shows a control loop on this machine, live in a terminal: state, timing,
//! recorder, events and values, for every controller whose values are declared.
//! The feature `flight` adds the parts for an aircraft, such as a horizon.
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
pub use watched::{ScreenPart, Watched};
