//! A `libandroid.so` for tests on a PC: loopers, event queues, sensors and performance
//! hints, which do what a test tells them. Never shipped.
//!
//! What they are to do is JSON, an object in each line: from `fake_libandroid_control`,
//! from the file that the environment names as `FAKE_LIBANDROID_SCRIPT`, or in datagrams
//! to its `FAKE_LIBANDROID_PORT`, with which sensors give nothing but what they are fed:
//!
//! ```json
//! {"package": "fcc.android", "type": 16, "sensor": {"jitter_us": 5000}}
//! {"package": "fcc.android", "type": 16, "event": {"stamp_ns": 1, "values": [0.1]}}
//! {"performance_hints": {"refuses": true}}
//! ```
//!
//! Each package has sensors of its own, so that tests do not meet. Sessions of
//! performance hints are told apart by their threads; what became of them is read by
//! `fake_libandroid_hint_sessions`.
//!
//! | module | contents |
//! |---|---|
//! | `interface` | the functions of Android's sensors that are played |
//! | `performance_hints` | those of its performance hints |
//! | `control` | what a test tells the sensors |
//! | `loaded` | the same for tests in Rust |
//! | `played` | sensors and queues, and the events that are due |

mod control;
mod interface;
pub mod loaded;
mod performance_hints;
mod played;
