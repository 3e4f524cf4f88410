//! The messages that a record and a remark give, for a file and for other carriers.

use fcc_core::framework::RecordOf;
use fcc_telemetry::schema::protobuf::encode;
use prost::Message as _;

use super::foxglove;
use super::schema::{OWN_TOPICS, Topic, topics};
use super::wire::log::Level;
use crate::recorded::{Recorded, TopicOf, Views};

/// The messages that records give, as in a recording.
#[derive(Debug)]
pub struct RecordMessages<C: Recorded> {
    views: C::Views,
    /// The buffer of a message, reused.
    bytes: Vec<u8>,
}

impl<C: Recorded> Default for RecordMessages<C> {
    fn default() -> Self {
        Self {
            views: C::Views::default(),
            bytes: Vec::new(),
        }
    }
}

impl<C: Recorded> RecordMessages<C> {
    /// The number of the topic of remarks.
    pub const LOG: usize = Topic::Log as usize;

    /// For each topic: its name, the type of its messages, and that type's
    /// `FileDescriptorSet`. All are encoded as Protobuf.
    pub fn topics() -> Vec<TopicOf> {
        topics::<C>()
    }

    /// Calls `put` with the number of the topic and the bytes of each message that a
    /// record gives; `unix_ns` is its time, since 1970.
    pub fn record(
        &mut self,
        record: &RecordOf<C>,
        unix_ns: u64,
        mut put: impl FnMut(usize, &[u8]),
    ) {
        self.bytes.clear();
        encode(record, &mut self.bytes);
        put(Topic::Record as usize, &self.bytes);
        self.views.take(record, unix_ns);
        for view in 0..C::Views::TOPICS.len() {
            self.bytes.clear();
            if self.views.append(view, &mut self.bytes) {
                put(OWN_TOPICS + view, &self.bytes);
            }
        }
    }

    /// The message of a remark.
    pub fn remark(text: &str, unix_ns: u64) -> Vec<u8> {
        let line = foxglove::line(foxglove::REMARK, text.to_owned(), Level::Info, unix_ns);
        line.encode_to_vec()
    }
}
