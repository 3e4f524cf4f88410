//! A `libandroid.so` for tests on a PC: loopers, event queues and sensors, which do what
//! a test tells them. Never shipped.
//!
//! What they are to do is JSON, from `fake_libandroid_control` or, if the environment
//! has `FAKE_LIBANDROID_PORT`, in datagrams to that port, an object in each line:
//!
//! ```json
//! {"package": "fcc.android", "type": 16, "sensor": {"jitter_us": 5000}}
//! {"package": "fcc.android", "type": 16, "event": {"stamp_ns": 1, "values": [0.1]}}
//! ```
//!
//! Each package has sensors of its own, so that tests do not meet.
//!
//! | module | contents |
//! |---|---|
//! | `interface` | the functions of Android's that are played |
//! | `control` | what a test tells the sensors |
//! | `played` | sensors and queues, and the events that are due |

mod control;
mod interface;
mod played;
