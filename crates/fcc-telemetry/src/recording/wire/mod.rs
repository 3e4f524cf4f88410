//! Between the loop's structs and the messages of `proto/`, bit for bit.

mod event;
mod record;

pub(crate) use event::{decode as decode_event, encode as encode_event};
pub(crate) use record::{decode as decode_record, encode as encode_record};

/// The messages of `proto/fcc/v1`.
#[allow(missing_docs, clippy::pedantic, unreachable_pub, reason = "generated")]
pub(crate) mod fcc {
    include!(concat!(env!("OUT_DIR"), "/fcc.v1.rs"));
}

/// The messages of `proto/foxglove`.
#[allow(missing_docs, clippy::pedantic, unreachable_pub, reason = "generated")]
pub(crate) mod foxglove {
    include!(concat!(env!("OUT_DIR"), "/foxglove.rs"));
}

/// A message that no version of the loop writes.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Eq, Debug)]
#[error("{0} is not one that is known")]
pub(crate) struct Unknown(pub(crate) &'static str);
