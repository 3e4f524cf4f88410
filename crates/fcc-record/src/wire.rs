//! The messages of `proto/foxglove`.
#![allow(missing_docs, clippy::pedantic, unreachable_pub, reason = "generated")]

include!(concat!(env!("OUT_DIR"), "/foxglove.rs"));
