//! The flight control computer inside an Android app: a native library, the host
//! of a flight beside the daemon and the Python module, on the same
//! `fcc-flight`.
//!
//! ```text
//! app's threads ─► native ─► handles ─► computer ─► flight's thread ─► loop's thread
//!                                          ▲             │ observers
//!                     state, recordings ◄── live ◄───────┤
//!                     the app's listener ◄── listener's thread
//! ```
//!
//! | module | content |
//! |---|---|
//! | `native` | the native methods of the class `fcc.android.Native` |
//! | `failure` | errors and panics as Java exceptions |
//! | `handles` | numbers for what Java holds; a closed one is refused |
//! | `computer` | one configuration, flown any number of times |
//! | `flight` | one flight in a thread of its own |
//! | `calibration` | a guided calibration in a thread of its own |
//! | `phone` | the phone's sensors in a flight |
//! | `live` | the state for the screens |
//! | `now` | its newest tick |
//! | `hints` | performance hints for the loop's thread |
//! | `commands` | commands of the app, and what became of them |
//! | `report` | a report on a recording |
//! | `release` | releases the controls if the app is killed |
//! | `listener` | calls of the app's listener, from a thread of its own |
//!
//! The loop's thread calls nothing of this crate: it fills its ring, and the
//! flight's thread reads it. What Java calls waits for that thread at most.

mod calibration;
mod commands;
mod computer;
mod failure;
mod flight;
mod handles;
mod hints;
mod listener;
mod live;
pub mod native;
mod now;
mod phone;
mod release;
mod report;
