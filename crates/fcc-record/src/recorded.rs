//! What a recording has beside records and events.

use std::borrow::Cow;

use fcc_core::framework::{Controller, RecordOf};
use fcc_telemetry::Telemetry;

/// A controller whose loop can be recorded.
pub trait Recorded: Telemetry {
    /// What its recordings have beside records and events; `()` for nothing.
    type Views: Views<Self>;
}

/// What a recording has beside records and events: messages of well-known types
/// that other programs can show.
pub trait Views<C: Controller + ?Sized>: Default + Send {
    /// Each topic, its message's type, and that type's `FileDescriptorSet`.
    const TOPICS: &'static [(&'static str, &'static str, &'static [u8])];

    /// Takes the next record; `unix_ns` is its time of day.
    fn take(&mut self, record: &RecordOf<C>, unix_ns: u64);

    /// Appends the message that one of the topics has for that record; whether
    /// it has one.
    fn append(&mut self, topic: usize, into: &mut Vec<u8>) -> bool;
}

/// Nothing beside records and events.
impl<C: Controller> Views<C> for () {
    const TOPICS: &'static [(&'static str, &'static str, &'static [u8])] = &[];

    fn take(&mut self, _: &RecordOf<C>, _: u64) {}

    fn append(&mut self, _: usize, _: &mut Vec<u8>) -> bool {
        false
    }
}

/// A topic, its message's type, and that type's description.
pub(crate) type TopicOf = (&'static str, String, Cow<'static, [u8]>);
