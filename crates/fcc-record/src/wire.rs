//! The messages of `proto/foxglove`.
#![allow(missing_docs, clippy::pedantic, unreachable_pub, reason = "generated")]
#![cfg_attr(
    not(feature = "flight"),
    allow(dead_code, reason = "what only an aircraft has")
)]

include!(concat!(env!("OUT_DIR"), "/foxglove.rs"));
